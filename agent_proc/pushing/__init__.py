"""Pushes the box to its goal, stage by stage and push by push."""
