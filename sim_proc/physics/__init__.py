"""The running physics; `Physics.run` is the one function that advances it."""
