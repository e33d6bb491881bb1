"""Where to go: paths of the trunk and of the box, planned with OMPL.

Another planner is plugged in at `legpush/plans/planner.py`; `docs/write_a_planner.md` builds one in any language.
"""
