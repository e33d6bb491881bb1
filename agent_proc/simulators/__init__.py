"""Simulators on the bus: worlds for an agent, and pools of them for a learner."""
