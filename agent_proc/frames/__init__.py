"""Where robot, box, goal and station are, relative to each other."""
