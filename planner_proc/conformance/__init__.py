"""Whether a planner process does what docs/protocol.md asks of one."""
