"""Which bits a computation gives: the numerics profile, how a process gets it, and how results name it."""
