"""Policies without learning that have the actions and the stop rule of a task: rivals of every learned one."""
