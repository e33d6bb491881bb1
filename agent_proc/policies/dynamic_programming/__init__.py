"""The policy that plans with the response of this very box: dynamic programming over its pose at the goal."""
