"""From a jagged route to a path that can be walked."""
