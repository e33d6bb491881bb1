"""Options of `legpush render`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, get_args

import tyro

from legpush.options.formats import View


@dataclass(frozen=True)
class RenderOptions:
    """Film a run again from its journal: write mission.mp4 into its folder."""

    run_folder: Annotated[Path, tyro.conf.arg(metavar="RUN_FOLDER")]
    """The folder of the run."""
    camera: Annotated[View, tyro.conf.arg(metavar="|".join(get_args(View)))] = "follow"
    """Position of the camera; `legpush export --help` describes each."""
