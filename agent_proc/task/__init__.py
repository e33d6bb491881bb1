"""The learning task: what a policy observes, does, and is rewarded for."""
