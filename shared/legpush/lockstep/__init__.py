"""One action, one answer, exactly once."""
