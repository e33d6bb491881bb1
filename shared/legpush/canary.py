"""A short computation whose bits show whether this process computes what others do: `legpush canary`."""

import sys
from importlib.resources import files
from typing import Final
from zlib import crc32

import msgspec
from msgspec import Struct

from legpush.geometry import Pose2
from legpush.in_process import run, world
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.options.numerics import CanaryOptions
from legpush.output.reply import document
from legpush.policy_names import DEFAULT_POLICY
from legpush.service import run_command

PUBLISHED_FILE: Final = "canaries.json"
LEARNED_POLICY: Final = "variable"
TURNS: Final = ((0.1, -1.5), (0.0, 1.5))
"""Metres ahead and radians of turn of two paths. In the second turn the front feet would meet in the longest cycle."""
STRAIGHT_AHEAD: Final = {
    "goal.pose.x_m": 2.6,
    "goal.pose.y_m": 2.0,
    "goal.pose.yaw_deg": 0.0,
    "mission.max_push_cycles": 1,
}
"""There the policy chooses the first push; where the path of the box curves, it does not."""


class Canary(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The CRC-32 of each part as eight hexadecimal digits; they show where two machines differ."""

    plan: str
    """Of the planner's path for the trunk in the default scenario."""
    walk: str
    """Of the state of the simulator after a gait cycle along this path."""
    turn: str
    """Of the state after a gait cycle to the right, and one of a path to the left that takes its place."""
    push: str
    """Of the state after one push cycle, which the default policy chose after the planner planned the box's path."""
    learned: str
    """The same with a learned policy."""

    @property
    def crc(self) -> str:
        """One CRC-32 of all parts."""
        return f"{crc32(msgspec.json.encode(self)):08x}"


def compute() -> Canary:
    """Compute the canary in this process, which takes about a second.

    Raises:
        LegpushError: Planner, simulator, policy or mission is not installed, or fails.
    """
    with world("default", seed=0) as walking:
        plan = walking.plan()
        walking.follow(plan)
        walked = walking.walk()
        for ahead_m, turn_rad in TURNS:
            ahead = walking.trunk @ Pose2(x_m=ahead_m, y_m=0.0, yaw_rad=0.0)
            walking.follow([walking.trunk, ahead, ahead @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=turn_rad)])
            turned = walking.walk()
    pushed, learned = (
        run("push", seed=0, policy=policy, changes=STRAIGHT_AHEAD) for policy in (DEFAULT_POLICY, LEARNED_POLICY)
    )
    return Canary(
        plan=f"{crc32(msgspec.msgpack.encode(plan)):08x}",
        walk=f"{walked.state_crc:08x}",
        turn=f"{turned.state_crc:08x}",
        push=pushed.state_crc,
        learned=learned.state_crc,
    )


def published(numerics: str) -> Canary | None:
    """Return the canary that was published for numerics of this name, such as `x86-64-v3/1a2b3c4d`; None if none was.

    That of `native` numerics is never published: it holds for one kind of processor.
    """
    text = files("legpush").joinpath(PUBLISHED_FILE).read_bytes()
    return msgspec.json.decode(text, type=dict[str, Canary]).get(numerics)


def main() -> int:
    """Run the program of `legpush canary`; returns the exit code."""
    return run_command("canary", CanaryOptions, lambda _: tell())


def tell() -> int:
    """Print numerics and canary; return 1 if another canary was published for these numerics."""
    numerics, canary = current(), compute()
    expected = published(numerics.name)
    lines = {
        "numerics": numerics.name,
        "why native": numerics.why_native,
        "versions": ", ".join(f"{name} {version}" for name, version in numerics.versions.items()),
        "motions": f"version {MOTION_VERSION}",
        "canary": canary.crc,
        **msgspec.to_builtins(canary),
        "published": "none for these numerics" if expected is None else expected.crc,
    }
    sys.stdout.write("".join(f"{title:<12}{text}\n" for title, text in lines.items() if text))
    document(
        {
            "numerics": numerics.name,
            "why_native": numerics.why_native,
            "versions": numerics.versions,
            "motion_version": MOTION_VERSION,
            "canary": canary.crc,
            "parts": canary,
            "published": None if expected is None else expected.crc,
        }
    )
    if expected in (None, canary):
        return 0
    parts = [name for name in canary.__struct_fields__ if getattr(canary, name) != getattr(expected, name)]
    sys.stdout.write(f"this machine computes other bits than were published, in: {', '.join(parts)}\n")
    return 1
