"""`python -m legpush.numerics`: prints the numerics of a process that is started here as JSON."""

import sys

import msgspec

from legpush.numerics.current import current
from legpush.numerics.entry import enter_profile

if __name__ == "__main__":
    enter_profile()
    numerics = current()
    text = msgspec.json.encode({"name": numerics.name, **msgspec.to_builtins(numerics)})
    sys.stdout.write(f"{text.decode()}\n")
