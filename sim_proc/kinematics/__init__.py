"""Kinematics of the robot's legs."""
