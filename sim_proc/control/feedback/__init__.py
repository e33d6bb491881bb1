"""What control does about a robot that does not move as planned."""
