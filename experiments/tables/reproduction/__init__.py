"""What it takes to learn the task of the paper: the factorial, the ladder, trainings and rules in the simulator."""
