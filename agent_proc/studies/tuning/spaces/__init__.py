"""Built-in search spaces, one for each algorithm."""
