"""Means, medians, shares and ratios with 95 % intervals."""
