"""Training profiles, and how they are read."""
