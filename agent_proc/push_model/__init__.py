"""What a push does to a box: as assumed, as measured, and as learned during a mission."""
