"""Paths of the trunk for the true body of the robot, which is longer than it is wide, so headings count."""
