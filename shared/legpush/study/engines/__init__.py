"""Engines run jobs in worker processes: on this machine, on a Ray cluster, or on Slurm."""
