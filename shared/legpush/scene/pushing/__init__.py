"""What pushing a box takes of a robot."""
