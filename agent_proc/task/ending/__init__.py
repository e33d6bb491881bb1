"""Rules that end an episode: a policy has nothing left to do, or the episode is given up."""
