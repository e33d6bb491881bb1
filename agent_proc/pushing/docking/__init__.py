"""Docking: the last steps of the box to its goal, as pushes at any face and walks around the box in between."""
