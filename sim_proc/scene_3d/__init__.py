"""The world of an episode as a scene of viser, row by row: for the page of a viewer, and for a file that needs none."""
