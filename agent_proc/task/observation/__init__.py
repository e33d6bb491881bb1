"""Terms of observations, a module for each frame."""
