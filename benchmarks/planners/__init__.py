"""Cells that compare planners by time, length and clearance, and the measurement of their speed."""
