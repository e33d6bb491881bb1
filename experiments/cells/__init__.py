"""Kinds of cells of the studies: what the installed kinds do not cover. Each is a function of its specification."""
