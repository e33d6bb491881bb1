"""The planners by name, beside each other and beside planners of others: how fast, how short, how far from walls."""
