"""Benchmarks of the robot: what it does at every physics step, and how that depends on model and surroundings."""
