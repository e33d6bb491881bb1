"""`python -m legpush.entry PROGRAM OPTIONS...`: a program of legpush, such as `agent_proc.programs.train`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main(sys.argv.pop(1), profile=True))
