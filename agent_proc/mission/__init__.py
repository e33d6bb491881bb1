"""A mission: plan, walk, hand over, push; and the process around it.

Obstacles that appear are noticed in `walking/obstacles.py` and `pushing/obstacles.py`.
"""
