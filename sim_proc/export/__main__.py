"""`python -m sim_proc.export`: the program behind `legpush export`."""

import signal
import sys


def main() -> int:
    """Export. An interrupt prints no traceback, not even while libraries are loaded."""
    for number in (signal.SIGINT, signal.SIGTERM):  # a background job of a shell would ignore SIGINT
        signal.signal(number, signal.default_int_handler)
    try:
        from sim_proc.export import program

        return program.main()
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
