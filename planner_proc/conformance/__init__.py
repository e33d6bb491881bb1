"""Checks whether a planner process, in any language, keeps the protocol of docs/protocol.md."""
