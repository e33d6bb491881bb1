"""Measured effects of pushes on one box by face, leg, curve and depth, and the circles on which it turns."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees
from pathlib import Path
from typing import Final, Literal, TypeVar

import msgspec
import numpy as np
from msgspec import Struct

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import MIRROR, PushModel
from agent_proc.statistics.estimate import Estimate
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.messages.codec import convert
from legpush.messages.common import USUAL_DEPTH_M
from legpush.scenarios.lines import lines_of, located_faults
from legpush.scenarios.schema_faults import schema_faults
from legpush.scene.conventions import FrontLeg
from legpush.scene.faces import FACES, PUSHABLE, pushed_box
from legpush.scene.names import BoxShape, Face
from legpush.scene.scenario import Box

T = TypeVar("T", bound=Struct)
LEAST_FORWARD_M: Final = 1e-4
LEAST_TURN_RAD: Final = 1e-4
"""A box cannot be steered if one push moves or turns it less than this."""
SAME_AS: Final[dict[BoxShape, dict[Face, Face]]] = {
    "cuboid": {"front": "rear", "left": "right"},
    "cylinder": {"right": "rear", "front": "rear", "left": "rear"},
    "wedge": {},
    "l_shape": {},
}
"""Faces that behave like another one, by symmetry."""


@dataclass(frozen=True, kw_only=True)
class Sample:
    """Displacement by one push, in the pushed frame before the push."""

    face: Face
    leg: FrontLeg
    w1: float
    w2: float
    depth_m: float
    forward_m: float
    left_m: float
    turn_rad: float


class PushEffect(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Mean displacement and turn of the box by one push cycle, with standard deviations over `n` pushes."""

    face: Face
    leg: FrontLeg
    w1: float
    w2: float
    depth_m: float
    n: int
    forward_m: float
    forward_sd_m: float
    left_m: float
    left_sd_m: float
    turn_deg: float
    turn_sd_deg: float


@dataclass(frozen=True, kw_only=True)
class Length(Estimate):
    """A length on a turning circle."""

    kind: str = "percentile bootstrap 95 %"
    """Maps of earlier versions do not name the kind; all of them have this one."""
    n: int = 0
    """Number of pushes; 0 in maps of earlier versions."""


class TurningCircle(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The circle on which one foot alone pushes the box, with 95 % intervals."""

    face: Face
    radius_m: Length
    """Radius of the circle of the axle, the point that does not slip sideways."""
    axle_m: Length
    """Distance of that point behind the box's centre."""


class PushMap(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of `push_map.json`."""

    format: Literal["legpush push map 1"] = "legpush push map 1"
    box: Box
    effects: tuple[PushEffect, ...]
    circles: tuple[TurningCircle, ...]
    command: str
    """The command that made the map."""

    def model(self, face: Face) -> PushModel:
        """The effects of pushes at a face with the first curve as a model; both legs are averaged."""
        measured = same_face(self.box, face)
        w1, w2 = self.effects[0].w1, self.effects[0].w2
        mine = [e for e in self.effects if (e.face, e.w1, e.w2) == (measured, w1, w2)]
        rows = [(0.0, 0.0, 0.0, 0.0)]
        for depth_m in sorted({effect.depth_m for effect in mine}):
            at = [effect for effect in mine if effect.depth_m == depth_m]
            mirrored = [(e.forward_m, MIRROR[e.leg] * e.left_m, MIRROR[e.leg] * e.turn_deg) for e in at]
            rows.append((depth_m, *np.average(mirrored, axis=0, weights=[e.n for e in at]).tolist()))
        depths, forward, left, turn = (tuple(column) for column in zip(*rows, strict=True))
        box = pushed_box(self.box, face)
        return PushModel(box=box, w1=w1, w2=w2, depth_m=depths, forward_m=forward, left_m=left, turn_deg=turn)


def measured_faces(box: Box) -> tuple[Face, ...]:
    """The faces to measure: every face that can be pushed behaves like one of them."""
    return tuple(face for face in FACES if face in PUSHABLE[box.shape] and face not in _same_as(box))


def same_face(box: Box, face: Face) -> Face:
    """The measured face that behaves like this one."""
    return _same_as(box).get(face, face)


def _same_as(box: Box) -> dict[Face, Face]:
    is_square = box.size_m[0] == box.size_m[1]
    return SAME_AS["cylinder" if box.shape == "cuboid" and is_square else box.shape]


def make_push_map(box: Box, samples: Sequence[Sample], command: str) -> PushMap:
    """Make the map from samples, at least two for each face, leg, curve and depth.

    Raises:
        ConfigError: One foot does not push the box forward and turn it.
    """
    groups: dict[tuple[Face, FrontLeg, float, float, float], list[Sample]] = {}
    for sample in samples:
        groups.setdefault((sample.face, sample.leg, sample.w1, sample.w2, sample.depth_m), []).append(sample)
    first = samples[0]
    circles = []
    for face in dict.fromkeys(sample.face for sample in samples):
        mine = [s for s in samples if (s.face, s.w1, s.w2) == (face, first.w1, first.w2)]
        depth_m = min({s.depth_m for s in mine}, key=lambda depth_m: abs(depth_m - USUAL_DEPTH_M))
        usual = [s for s in mine if s.depth_m == depth_m]
        _require_turn(face, depth_m, usual)
        circles.append(_circle(face, usual))
    return PushMap(
        box=box,
        effects=tuple(_effect(*key, group) for key, group in groups.items()),
        circles=tuple(circles),
        command=command,
    )


def _require_turn(face: Face, depth_m: float, samples: Sequence[Sample]) -> None:
    """Require that one foot moves the box forward and turns it away from itself."""
    forward_m = float(np.mean([sample.forward_m for sample in samples]))
    turn_rad = float(np.mean([-MIRROR[sample.leg] * sample.turn_rad for sample in samples]))
    if forward_m < LEAST_FORWARD_M or turn_rad < LEAST_TURN_RAD:
        raise ConfigError(
            f"Expected a box that one foot pushes forward and turns, but {depth_m} m deep at the {face} face it moves "
            f"{100 * forward_m:.2f} cm and turns {degrees(turn_rad):.2f}°: push deeper, or take another box"
        )


def _effect(face: Face, leg: FrontLeg, w1: float, w2: float, depth_m: float, samples: Sequence[Sample]) -> PushEffect:
    values = np.array([(s.forward_m, s.left_m, degrees(s.turn_rad)) for s in samples])
    (forward_m, left_m, turn_deg), (forward_sd_m, left_sd_m, turn_sd_deg) = (
        values.mean(axis=0).round(5).tolist(),
        values.std(axis=0, ddof=1).round(5).tolist(),
    )
    return PushEffect(
        face=face,
        leg=leg,
        w1=w1,
        w2=w2,
        depth_m=depth_m,
        n=len(samples),
        forward_m=forward_m,
        forward_sd_m=forward_sd_m,
        left_m=left_m,
        left_sd_m=left_sd_m,
        turn_deg=turn_deg,
        turn_sd_deg=turn_sd_deg,
    )


def _circle(face: Face, samples: Sequence[Sample]) -> TurningCircle:
    """Radius and axle: means of the displacements over the mean turn."""
    turn_rad = [-MIRROR[sample.leg] * sample.turn_rad for sample in samples]
    return TurningCircle(
        face=face,
        radius_m=_length([sample.forward_m for sample in samples], turn_rad),
        axle_m=_length([-MIRROR[sample.leg] * sample.left_m for sample in samples], turn_rad),
    )


def _length(displacements_m: Sequence[float], turns_rad: Sequence[float]) -> Length:
    # Missions read maps and make none, so they do not load SciPy.
    from agent_proc.statistics.intervals import ratio_of_means

    return Length(**asdict(ratio_of_means(displacements_m, turns_rad).rounded(4)))


def write_push_map(push_map: PushMap, path: Path) -> None:
    """Write the map as JSON."""
    write_whole(path, msgspec.json.format(msgspec.json.encode(push_map), indent=1) + b"\n")


def read_measured(path: Path, kind: type[T], wanted: str) -> T:
    """Read a record of measured pushes from a JSON file; `wanted` says in errors what the file should be.

    Raises:
        ConfigError: The file cannot be read, or is no such record; names the file, and every wrong field with its line.
    """
    try:
        text = path.read_text(encoding="utf-8")
        plain = msgspec.json.decode(text, type=dict)
    except OSError as error:
        raise ConfigError(f"{path}: {wanted} ({error.strerror})") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ConfigError(f"{path}: {wanted} ({error})") from error
    if faults := schema_faults(plain, kind, convert):
        raise ConfigError(*located_faults(faults, str(path), lines_of(text)))
    return convert(plain, kind)


def load_push_map(path: Path, box: Box) -> PushMap:
    """Read the map of this box from a file; mass and friction may differ.

    Raises:
        ConfigError: The file cannot be read, or is not a usable map of this box.
    """
    push_map = read_measured(path, PushMap, "expected a push map that `legpush calibrate` wrote")
    if (of := _solid(push_map.box)) != (expected := _solid(box)):
        raise ConfigError(
            f"{path}: expected the push map of {expected}, got that of {of}; `legpush calibrate` makes one"
        )
    have, need = {effect.face for effect in push_map.effects}, measured_faces(box)
    if missing := [face for face in need if face not in have]:
        raise ConfigError(f"{path}: expected effects of pushes at {', '.join(need)}, none at {', '.join(missing)}")
    first = push_map.effects[0]
    for face in need:
        depths_m = [e.depth_m for e in push_map.effects if (e.face, e.w1, e.w2) == (face, first.w1, first.w2)]
        if not depths_m or max(depths_m) < USUAL_DEPTH_M:
            raise ConfigError(f"{path}: expected pushes of {USUAL_DEPTH_M} m or more at the {face} face in the map")
        if PushEstimate(pushed_box(box, face), push_map.model(face)).turning_radius_m <= 0.0:
            raise ConfigError(f"{path}: expected pushes at the {face} face that turn the box away from the foot")
    return push_map


def _solid(box: Box) -> str:
    """The box in words, but for mass and friction."""
    words = f"a {box.shape} of " + " x ".join(f"{side:g}" for side in box.size_m) + " m"
    return f"{words} with com_offset_m {list(box.com_offset_m)}" if any(box.com_offset_m) else words
