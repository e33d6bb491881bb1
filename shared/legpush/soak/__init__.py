"""Faults on purpose: whole missions and trainings are disturbed, and must end as if nothing had happened."""
