"""`python -m experiments.policies runs/STUDY`: unpacks the best policies of a study of trainings.

The policy of each cell goes to `runs/policies/STUDY-SEED`.
"""

import base64
import io
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from legpush.errors import ConfigError
from legpush.service import run_program
from legpush.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which policies to unpack, and where."""

    folder: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="DIR")]
    """Folder of a study of trainings."""
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")] = Path("runs/policies")


def main(config: Config) -> int:
    """Unpack the policy of every cell.

    Raises:
        ConfigError: The study has no policies.
    """
    study = StudyFolder(config.folder)
    table = study.rows()
    if table is None or "policy_zip" not in table.column_names:
        raise ConfigError(f"{config.folder}: expected a study of trainings with rows")
    for row in table.to_pylist():
        out = config.out / f"{study.record().name}-{row['seed']}"
        with zipfile.ZipFile(io.BytesIO(base64.b64decode(row["policy_zip"]))) as packed:
            packed.extractall(out)
        print(out)
    return 0


if __name__ == "__main__":
    sys.exit(run_program("policies", lambda: main(tyro.cli(Config))))
