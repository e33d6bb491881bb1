"""The running physics. Only `Physics.run` advances it."""
