"""Rooms from grids in files: CSV, NumPy, images and ROS maps."""
