"""Comparisons of trainings and policies: who takes part, on which starts, and what comes out."""
