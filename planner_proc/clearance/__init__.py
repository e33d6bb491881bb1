"""Exact distances to the occupied cells of a grid."""
