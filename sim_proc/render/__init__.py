"""Renders films of a run off screen: `python -m sim_proc.render FOLDER`."""
