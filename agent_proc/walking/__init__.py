"""Walks to the box, around obstacles.

It chooses paths and notices obstacles; `sim_proc/control/` moves the feet.
"""
