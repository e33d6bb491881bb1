"""A mission: plan, walk, hand over, push; and the process around it."""
