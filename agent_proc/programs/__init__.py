"""The programs behind `legpush train`, `evaluate`, `calibrate`, `map` and `scenarios random`."""
