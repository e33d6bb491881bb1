"""`python -m sim_proc.render FOLDER`: renders the recorded episode of a run off screen as `mission.mp4`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("sim_proc.render.program"))
