"""The world as a MuJoCo model."""
