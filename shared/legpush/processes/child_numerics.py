"""The numerics of child processes, which need not be those of the launcher."""

import os
import subprocess
import sys
from typing import Any

import msgspec

from legpush.errors import PeerError
from legpush.processes.environment import child_environment


def child_numerics() -> str:
    """Return the name of the numerics that a child process has, asked of one.

    Raises:
        PeerError: It fails.
    """
    command = [sys.executable, "-P", "-m", "legpush.numerics"]
    done = subprocess.run(command, env=child_environment(os.environ), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise PeerError(f"Expected the numerics of a child process, got {done.stderr.strip() or done.returncode}")
    return str(msgspec.json.decode(done.stdout, type=dict[str, Any])["name"])
