"""The motion of the robot, estimated from what its own sensors read."""
