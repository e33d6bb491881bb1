"""Tuning: the settings of a training profile are searched, each trial judged over several seeds."""
