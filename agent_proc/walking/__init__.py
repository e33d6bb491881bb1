"""Walks to the box, around obstacles."""
