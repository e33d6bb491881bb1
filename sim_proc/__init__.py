"""What happens: the robot, the box and the room, simulated with MuJoCo.

Feet are moved in `control/`, for walking and for pushing alike; the agent only says along which path, or which push.
"""
