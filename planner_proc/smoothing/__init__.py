"""Turns a jagged route into a path that can be walked."""
