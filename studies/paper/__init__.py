"""The paper study: four actuators by every model, beside the paper's own numbers and statements."""
