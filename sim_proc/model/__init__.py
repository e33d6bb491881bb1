"""The world as a MuJoCo model: robot, box, room and contacts."""
