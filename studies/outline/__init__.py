"""The outline study: how much of the gap between closed form and finite elements is the outline that is meshed."""
