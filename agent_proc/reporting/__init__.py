"""Reports and pictures of missions and maps."""
