"""The strip that a meridian is cut from: its cells in coordinates along and across, and places found in them."""
