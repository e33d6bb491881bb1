"""What happens: the robot, the box and the room, simulated with MuJoCo."""
