"""A folder on the path of Python in which it finds the entry hook of every process of a disturbed mission."""
