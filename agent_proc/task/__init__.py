"""The learning task: action, observation, reward and end of an episode."""
