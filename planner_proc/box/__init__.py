"""Paths of the box with the robot behind it."""
