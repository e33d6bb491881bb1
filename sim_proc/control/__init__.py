"""Walking and pushing: footsteps, balance and swings, in NumPy alone."""
