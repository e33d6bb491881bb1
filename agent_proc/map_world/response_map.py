"""The measured response of a box to pushes as a file: a surface for each face, and how the robot stands."""

from functools import cached_property
from importlib.resources import files
from pathlib import Path
from statistics import fmean
from typing import Annotated, Any, Final, Literal

import msgspec
import numpy as np
from msgspec import Meta, Struct
from numpy.typing import ArrayLike

from agent_proc.map_world.fit import fit_surface
from agent_proc.map_world.random_pushes import MeasuredSeries, Stance, mean_stance
from agent_proc.map_world.surface import ResponseSurface
from agent_proc.push_model.map import measured_faces, read_measured, same_face
from legpush.arrays import Floats
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.scenarios.file import robot_table
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.names import BoxShape, Face
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box

SYMMETRIC: Final[tuple[BoxShape, ...]] = ("cuboid", "cylinder")
"""Shapes that look the same in a mirror from every face, so that FR does the mirror image of FL."""
DEFAULT_FILE: Final = "default_box.json"


class Stances(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot stands on average."""

    start: Stance
    """After a reset at the station."""
    FL: Stance
    """After a push with FL."""
    FR: Stance


class ResponseMap(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, dict=True):
    """The content of a file that `legpush calibrate --random-pushes` writes."""

    format: Literal["legpush response map 1"] = "legpush response map 1"
    box: Box
    robot: RobotSpec
    """In the file, only what differs from the defaults."""
    surfaces: Annotated[tuple[ResponseSurface, ...], Meta(min_length=1)]
    stances: Stances
    ticks_per_push: int
    footsteps_per_push: int
    peak_force_n: float
    """Mean of the largest contact force of each push."""
    command: str
    """The command that made the map."""
    versions: dict[str, str] = {}
    """Of everything that was installed."""

    def surface(self, face: Face) -> ResponseSurface:
        """The surface of a face, or of the one that behaves alike.

        Raises:
            ConfigError: The face was not measured.
        """
        found = self._by_face.get(same_face(self.box, face))
        if found is None:
            raise ConfigError(f"Expected a face among {', '.join(self._by_face)} of the map, got {face}")
        return found

    def push(
        self,
        poses: Floats,
        mirror: Floats,
        depth_m: Floats,
        w1: Floats,
        w2: Floats,
        *,
        face: Face = "rear",
        first: ArrayLike = False,
        normal: Floats | None = None,
    ) -> Floats:
        """Poses (x, y, yaw) of many pushed frames after one push each, (n, 3).

        `mirror` is 1 for FL and -1 for FR, and `first` is whether a push is the first one after a reset; they, the
        depths, w1 and w2 are (n,). `normal` has standard normal numbers for the residuals, (n, 3); None leaves them
        out.
        """
        surface = self.surface(face)
        moved = surface.displacement(mirror, depth_m, w1, w2, first=first)
        if normal is not None:
            moved = moved + surface.residual(mirror, depth_m, normal)
        forward, left, turn = moved.T
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        after: Floats = poses + np.stack([c * forward - s * left, s * forward + c * left, turn], axis=1)
        return after

    @cached_property
    def _by_face(self) -> dict[Face, ResponseSurface]:
        return {surface.face: surface for surface in self.surfaces}


def make_response_map(
    robot: RobotSpec, box: Box, series: list[MeasuredSeries], command: str, versions: dict[str, str]
) -> ResponseMap:
    """Fit the map to series of random pushes at every face of `measured_faces`.

    Raises:
        ConfigError: There are too few pushes at a face.
    """
    pushes = [push for each in series for push in each.pushes]
    after = {leg: mean_stance([push.after for push in pushes if push.leg == leg]) for leg in FRONT_LEGS}
    return ResponseMap(
        box=box,
        robot=robot,
        surfaces=tuple(fit_surface([s for s in series if s.face == face]) for face in measured_faces(box)),
        stances=Stances(start=mean_stance([each.before for each in series]), **after),
        ticks_per_push=round(fmean(push.n_ticks for push in pushes)),
        footsteps_per_push=round(fmean(push.n_footsteps for push in pushes)),
        peak_force_n=round(fmean(push.peak_force_n for push in pushes), 3),
        command=command,
        versions=versions,
    )


def require_symmetric(box: Box) -> None:
    """Require a box whose mirror image is the box itself.

    Raises:
        ConfigError: It has another shape.
    """
    if box.shape not in SYMMETRIC:
        raise ConfigError(
            f"Expected a box of the shape {' or '.join(SYMMETRIC)} for random pushes, got {box.shape}: pushes of the "
            "right leg are taken as mirror images of pushes of the left one"
        )


def write_response_map(response_map: ResponseMap, path: Path) -> None:
    """Write the map as JSON.

    Raises:
        DiskError: It cannot be written.
    """
    plain: dict[str, Any] = msgspec.to_builtins(response_map)
    plain["robot"] = robot_table(response_map.robot)
    write_whole(path, msgspec.json.format(msgspec.json.encode(plain), indent=1) + b"\n")


def load_response_map(path: Path | None = None) -> ResponseMap:
    """Read a map, or the one of the default box that comes with this package.

    Raises:
        ConfigError: The file cannot be read, or is not a usable map; names the file and the field.
    """
    path = path or Path(str(files("agent_proc") / "map_world" / DEFAULT_FILE))
    return read_measured(path, ResponseMap, "expected a map that `legpush calibrate --random-pushes` wrote")
