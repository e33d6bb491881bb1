"""`python -m legpush.numerics`: prints the numerics of a process that is started here as JSON."""

import sys

from legpush.numerics.current import current
from legpush.numerics.entry import enter_profile
from legpush.output.guarded_streams import Output, with_guarded_output


def main(_: Output) -> int:
    """Print the numerics."""
    sys.stdout.write(f"{current().as_json().decode()}\n")
    return 0


if __name__ == "__main__":
    enter_profile()
    sys.exit(with_guarded_output(main))
