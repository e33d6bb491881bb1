"""What happened in a run, as it can be read afterwards."""
