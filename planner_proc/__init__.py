"""Where to go: paths of the trunk and of the box, planned with OMPL."""
