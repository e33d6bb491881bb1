"""Asking a planner, and being one."""
