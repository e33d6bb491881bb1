"""Tries the OpenGL backends for `legpush doctor`, and prints one JSON object."""

import json
import sys

from sim_proc.render.backends import try_backends


def main() -> int:
    """Print the backend that draws, and why others do not; returns 0."""
    backend, failures = try_backends()
    sys.stdout.write(json.dumps({"backend": None if backend is None else backend.name, "failures": failures}) + "\n")
    return 0
