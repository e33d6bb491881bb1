"""What is measured of a motion at every physics step: joints, loads of the feet, stability, and contacts."""
