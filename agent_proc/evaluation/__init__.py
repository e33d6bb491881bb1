"""Episodes from seeded starts, sweeps over them, and intervals of their results."""
