"""The robot in numbers: leg kinematics, standing pose, masses and servo gains."""
