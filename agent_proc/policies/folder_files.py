"""Reads the files of a policy folder from elsewhere: within limits, and nothing outside the folder."""

import io
import zipfile
from pathlib import Path
from typing import Any, Final

import msgspec

from legpush.errors import PolicyError

MAX_BYTES: Final = 64 * 2**20
"""Largest size of a file, and of what a zip unpacks to."""
WEIGHTS_SUFFIX: Final = ".pth"
"""Members of a zip of Stable-Baselines3 that are zips of PyTorch themselves."""


def read_file(path: Path) -> bytes:
    """The content of a file of a policy folder.

    Raises:
        PolicyError: It cannot be read, is no file, is too large, or is a link to a place outside its folder.
    """
    if not path.resolve().is_relative_to(path.parent.resolve()):
        raise PolicyError(f"{path}: expected a file in the policy folder, got a link that leaves it")
    if path.exists() and not path.is_file():
        raise PolicyError(f"{path}: expected this file of a policy, got something that is no file")
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise PolicyError(f"{path}: expected this file of a policy ({error.strerror})") from error
    if len(content) > MAX_BYTES:
        raise PolicyError(f"{path}: expected at most {MAX_BYTES} bytes, got more")
    return content


def decode_file(path: Path, kind: Any) -> Any:
    """The content of a JSON file of a policy folder, as a `kind`.

    Raises:
        PolicyError: It cannot be read, or is no JSON of that kind.
    """
    try:
        return msgspec.json.decode(read_file(path), type=kind)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise PolicyError(f"{path}: {error}") from error


def require_small_zip(content: bytes, where: str) -> None:
    """Check that the networks are a zip that unpacks to no more than `MAX_BYTES`, with the zips of weights in it.

    Raises:
        PolicyError: They are something else, or larger; the message begins with `where`.
    """
    if not zipfile.is_zipfile(io.BytesIO(content)):
        raise PolicyError(f"{where}: expected a policy of Stable-Baselines3 (a zip), got other bytes")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            _require_small(archive, where)
            for name in archive.namelist():
                if name.endswith(WEIGHTS_SUFFIX):
                    weights = io.BytesIO(archive.read(name))
                    if zipfile.is_zipfile(weights):
                        with zipfile.ZipFile(weights) as inner:
                            _require_small(inner, f"{where}/{name}")
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, RuntimeError, EOFError, OSError) as error:
        raise PolicyError(f"{where}: expected a policy of Stable-Baselines3 ({error})") from error


def _require_small(archive: zipfile.ZipFile, where: str) -> None:
    size = sum(member.file_size for member in archive.infolist())
    if size > MAX_BYTES:
        raise PolicyError(f"{where}: expected a zip that unpacks to at most {MAX_BYTES} bytes, got {size}")
