"""Films of a run, rendered off screen: `python -m sim_proc.render FOLDER`."""
