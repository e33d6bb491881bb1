"""Writes the golden messages again: `python tests/golden/regenerate.py`.

Only on purpose: a change of these bytes is a change of the protocol, and raises its version.
"""

from pathlib import Path

import msgspec

from legpush.messages import codec
from tests.legpush.examples import MESSAGES

if __name__ == "__main__":
    folder = Path(__file__).parent
    for name, message in MESSAGES.items():
        (folder / f"{name}.msgpack").write_bytes(codec.encode(message))
        (folder / f"{name}.json").write_bytes(msgspec.json.format(msgspec.json.encode(message), indent=1) + b"\n")
