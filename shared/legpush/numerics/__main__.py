"""`python -m legpush.numerics`: prints the numerics of a process that is started here as JSON."""

import sys

from legpush.numerics.current import current
from legpush.numerics.entry import enter_profile

if __name__ == "__main__":
    enter_profile()
    sys.stdout.write(f"{current().as_json().decode()}\n")
