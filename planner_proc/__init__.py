"""Where to go: paths for the trunk, planned with OMPL."""
