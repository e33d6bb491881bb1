"""Policies of Stable-Baselines3: their arguments, their weights as plain arrays, and their files; needs PyTorch."""
