"""The launcher: starts planner, simulator and agent, watches over them, and reports how the mission ended."""
