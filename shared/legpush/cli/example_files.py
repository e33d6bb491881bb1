"""The examples, as they lie in a checkout or beside an installed package, for `legpush examples`."""

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Final

from legpush.errors import ConfigError
from legpush.files import replace_folder

IN_CHECKOUT: Final = "examples"
INSTALLED: Final = "share/legpush/examples/"
"""Where the wheel puts them, below the folder of the environment."""
LEFT_OUT: Final = ("__pycache__",)


def example_files() -> dict[str, Path]:
    """Return the files by their paths in the folder of examples, sorted.

    Those of the checkout come first: a package that is installed from it, editable, shows its present examples.

    Raises:
        ConfigError: There are none.
    """
    checkout = Path(__file__).parents[3]
    folder = checkout / IN_CHECKOUT
    if (checkout / "pyproject.toml").is_file() and folder.is_dir():
        found = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file()}
    else:
        found = _installed()
    kept = {name: path for name, path in sorted(found.items()) if not {*LEFT_OUT} & {*Path(name).parts}}
    if not kept:
        raise ConfigError("Expected examples beside the package, found none; install the wheel, or use a checkout")
    return kept


def _installed() -> dict[str, Path]:
    """Return the files that the installer of the wheel noted."""
    try:
        files = distribution("legpush").files or ()
    except PackageNotFoundError:
        return {}
    found = {}
    for file in files:
        _, mark, name = file.as_posix().partition(INSTALLED)
        if mark:
            found[name] = Path(str(file.locate())).resolve()
    return found


def copy_examples(target: Path) -> tuple[Path, ...]:
    """Copy all examples into a new folder, and return the new files.

    Raises:
        ConfigError: The folder exists, or cannot be made.
    """
    if target.exists() or not target.absolute().parent.is_dir():
        raise ConfigError(f"Expected a new folder in an existing one for DIR, got {target}")
    sources = example_files()

    def fill(folder: Path) -> None:
        for name, source in sources.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(source.read_bytes())

    replace_folder(target, fill)
    return tuple(target / name for name in sources)
