"""The picture of a mission: the room with its paths, the pushes, and charts over time."""
