"""Scenarios as files, built in or drawn at random, and the maps they name."""
