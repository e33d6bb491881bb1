"""Numbers and pictures of missions and maps."""
