"""The agent: it runs the mission and decides about each push."""
