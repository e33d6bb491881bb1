"""The Gymnasium environment, and training on many simulators."""
