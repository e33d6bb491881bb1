"""How messages travel: keys, channels, links, and which processes are there."""
