"""What the robot is not told: how the world differs from what control and planning assume, and what is perceived of it.

A scenario states it in `[realism]`, and the seed of an episode draws from it.
"""
