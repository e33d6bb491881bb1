"""The options of each command: typed records, nothing else."""
