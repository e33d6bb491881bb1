"""The robot, the box, the room and the goal: what a mission is about."""
