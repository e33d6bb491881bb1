"""The agent: it runs the mission and decides about each push.

`mission/` has the order of events. What is noticed on the way lies where the robot is at that time: in `walking/` or in
`pushing/`. What a policy sees, does and earns is in `task/`; feet are moved in the simulator, `sim_proc/control/`.
"""
