"""The world without physics against the simulator: speed, errors, and the order of policies."""
