"""`legpush kernel`: installs a Jupyter kernel under the numerics profile."""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.numerics.profile import X86_64_V3, profile_variables, why_not_here
from legpush.options.numerics import KernelOptions
from legpush.output.reply import document


def install_kernel(options: KernelOptions) -> int:
    """Write the kernel specification, tell where it is, and return the exit code.

    Raises:
        ConfigError: This machine cannot keep the profile, the name is no folder's, or the file cannot be written.
    """
    if why := why_not_here():
        raise ConfigError(f"Expected a machine that can keep the numerics profile: {why}")
    if options.name in ("", ".", "..") or not options.name.replace("-", "").replace("_", "").replace(".", "").isalnum():
        raise ConfigError(f"Expected letters, digits and ._- for --name, got {options.name!r}")
    data = jupyter_folder(os.environ) if options.prefix is None else options.prefix / "share" / "jupyter"
    file = data / "kernels" / options.name / "kernel.json"
    specification = {
        "argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
        "display_name": f"Python ({options.name}, {X86_64_V3})",
        "language": "python",
        "env": profile_variables({}),
        "metadata": {"debugger": True},
    }
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"Expected a folder that can be made, got {file.parent} ({error.strerror})") from error
    write_whole(file, (json.dumps(specification, indent=1) + "\n").encode())
    sys.stdout.write(f"wrote {file}\n")
    document({"file": file})
    return 0


def jupyter_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder where Jupyter looks for what the user installed."""
    if folder := environment.get("JUPYTER_DATA_DIR"):
        return Path(folder)
    shared = environment.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(shared) / "jupyter"
