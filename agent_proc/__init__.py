"""What to do: the mission and the pushing policy."""
