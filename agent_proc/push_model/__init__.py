"""What a push does to a box: assumed, measured, and learned during a mission."""
