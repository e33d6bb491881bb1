"""What the planner, the simulator and the agent say to each other: messages, bus, lockstep, scenarios, launcher."""
