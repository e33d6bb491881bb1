"""Compares all planners with each other and with planners of other projects: time, length and clearance."""
