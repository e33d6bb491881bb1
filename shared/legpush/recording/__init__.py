"""Recordings of runs as MCAP files: made, read, repaired, verified, played and continued."""
