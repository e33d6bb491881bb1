"""Tables of the benchmark: its levels, and how far beside the line a start may be."""
