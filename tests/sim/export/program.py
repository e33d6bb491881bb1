"""`legpush export` as a user calls it."""

import subprocess
import sys
from pathlib import Path

CLI = [sys.executable, "-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())", "export"]


def export(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run it to its end."""
    command = [*CLI, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd, timeout=120)
