"""Missions as a Gymnasium environment: an action is a push that the mission asks its policy for."""
