"""Writes an episode as an MCAP file for Foxglove: a scene, its transforms, joints, plans, numbers to plot, and a log.

At any moment Foxglove shows the last message of each topic. So each message is complete by itself, and things that
stand still, things that appear later, and things that change with every tick have separate topics.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import foxglove
import msgspec
import numpy as np
from foxglove.channels import (
    FrameTransformsChannel,
    JointStatesChannel,
    LogChannel,
    PosesInFrameChannel,
    SceneUpdateChannel,
)
from foxglove.messages import (
    FrameTransform,
    FrameTransforms,
    JointState,
    JointStates,
    Log,
    LogLevel,
    PosesInFrame,
    SceneUpdate,
    Timestamp,
)

from legpush.geometry import Pose2
from legpush.history.run_history import PlanAt, Said
from legpush.history.timeline import BOX, JOINTS, TRUNK, TimelineStep
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Follow, Reset
from legpush.scene.conventions import CONTROL_PERIOD_S, LEG_JOINTS
from sim_proc.export.columns import columns_of
from sim_proc.export.foxglove_scene import (
    BOX_BROWN,
    TREE_GREY,
    TRUNK_ORANGE,
    body_entity,
    feet_entities,
    line_entity,
    pose,
    quaternion,
    robot_bodies,
    vector,
)
from sim_proc.export.foxglove_schemas import STEP_SCHEMA, STRING_SCHEMA, signals_schema
from sim_proc.export.source import Exported, Source
from sim_proc.export.steady_file import SteadyFile
from sim_proc.export.transforms import WORLD, Frame, moving_frames, standing_frames
from sim_proc.export.urdf import robot_urdf
from sim_proc.model.scenery import wall_name
from sim_proc.model.shapes import parts_of

PERIOD_NS: Final = round(CONTROL_PERIOD_S * 1e9)
TIMES: Final = "start of the episode since 1970, plus simulated time"
TRAIL_STRIDE_TICKS: Final = 10
"""Ticks between the points of the trails of trunk and box."""
SAY_EVERY_ROWS: Final = 1000
"""How often to report progress."""
NOT_PLOTTED: Final = ("episode", "sim", "motion")
"""Columns that are constant or words, which `/signals` leaves out."""


def write_foxglove(
    source: Source, episode: Exported, about: Mapping[str, str], path: Path, say: Callable[[int, int], None]
) -> str:
    """Write the file and return a description of it in a few words.

    Raises:
        OSError: The file cannot be written.
    """
    context = foxglove.Context()
    writer = _Writer(source, episode, context)
    facts = {"episode": str(episode.index), "scenario": episode.timeline.scenario.name, "times": TIMES}
    with SteadyFile(path) as disk, foxglove.open_mcap(disk, context=context) as file:
        file.write_metadata("legpush", {**about, **facts})
        for name, attachment in source.recording.attachments.items():
            file.attach(
                log_time=writer.time_ns(0),
                create_time=writer.time_ns(0),
                name=name,
                media_type=attachment.media_type,
                data=attachment.data,
            )
        for row in writer.rows():
            if row % SAY_EVERY_ROWS == 0:
                disk.check()
                say(row, episode.timeline.n_rows)
    say(episode.timeline.n_rows, episode.timeline.n_rows)
    return f"{writer.n_messages} messages, {episode.timeline.time_s[-1] - episode.timeline.time_s[0]:.1f} s"


class _Writer:
    """Writes the messages of one episode in the order of their times."""

    def __init__(self, source: Source, episode: Exported, context: foxglove.Context) -> None:
        """Write to the channels of this context."""
        self._source, self._episode, self._timeline = source, episode, episode.timeline
        self._context = context
        self._channels: dict[str, Any] = {}
        self._parts = parts_of(episode.timeline.scenario, episode.timeline.reality)
        self.n_messages = 0

    def rows(self) -> Iterator[int]:
        """Write the messages row by row, and yield each row after its messages."""
        timeline = self._timeline
        self._write_once()
        events = self._events()
        frames = moving_frames(self._parts, timeline.qpos)
        series = [column for column in columns_of([self._episode]) if column.name not in NOT_PLOTTED]
        schema = signals_schema(series)
        values = [column.values.tolist() for column in series]
        names = [column.name for column in series]
        for row in range(timeline.n_rows):
            for event in events.get(row, ()):
                event()
            self._log(FrameTransformsChannel, "/tf", row, _transforms(frames, row, self._stamp(row)))
            self._write_joints(row)
            self._write_feet(row)
            signals = {name: column[row] for name, column in zip(names, values, strict=True)}
            self._log_json("/signals", row, schema, {name: each for name, each in signals.items() if each == each})
            yield row

    def time_ns(self, row: int) -> int:
        """Time of a row."""
        tick = self._timeline.tick
        return self._timeline.steps[0].time_ns + int(tick[row] - tick[0]) * PERIOD_NS

    def _stamp(self, row: int) -> Timestamp:
        sec, nsec = divmod(self.time_ns(row), 1_000_000_000)
        return Timestamp(sec=sec, nsec=nsec)

    def _write_once(self) -> None:
        """Write what never changes: the room, the shapes of robot and box, and the trails that both will follow."""
        stamp, robot = self._stamp(0), robot_bodies()
        later = {
            wall_name(i) for i, wall in enumerate(self._timeline.scenario.room.obstacles) if wall.appears_at_s > 0.0
        }
        scenes = {
            "/scene/room": [part for part in self._parts if part.joint == "none" and part.name not in later],
            "/scene/robot": [part for part in self._parts if part.name in robot],
            "/scene/box": [part for part in self._parts if part.name == "box"],
        }
        for topic, parts in scenes.items():
            self._log_scene(topic, 0, [body_entity(part, stamp) for part in parts if part.shapes])
        self._log(FrameTransformsChannel, "/tf_static", 0, _transforms(standing_frames(self._parts), 0, stamp))
        self._log_json("/robot_description", 0, STRING_SCHEMA, {"data": robot_urdf(self._timeline.scenario)})
        trails = (("trunk_trail", TRUNK, TRUNK_ORANGE), ("box_trail", BOX, BOX_BROWN))
        ways = {name: self._timeline.qpos[::TRAIL_STRIDE_TICKS, columns][:, :2] for name, columns, _ in trails}
        entities = [line_entity(name, ways[name], rgba, stamp) for name, _, rgba in trails]
        self._log_scene("/scene/trails", 0, entities)

    def _events(self) -> dict[int, list[Callable[[], None]]]:
        """Writers of the messages between ticks: steps, obstacles that appear, plans and statuses, by row."""
        events: dict[int, list[Callable[[], None]]] = {}

        def at(row: int, write: Callable[..., None], *about: object) -> None:
            events.setdefault(row, []).append(partial(write, row, *about))

        timeline, history = self._timeline, self._source.history
        for step in timeline.steps:
            at(max(0, min(step.first_row, timeline.n_rows) - 1), self._write_step, step)
        for appearance in timeline.steps[-1].world.appeared:
            row = int(np.searchsorted(timeline.tick, appearance.tick))
            at(min(row, timeline.n_rows - 1), self._write_appeared)
        for row, planned in history.plans_of(timeline):
            at(row, self._write_plan, planned)
        began, ended = history.span_ns(timeline)
        for said in history.said:
            if began <= said.time_ns <= ended:
                at(timeline.row_at(said.time_ns), self._write_said, said)
        return events

    def _write_joints(self, row: int) -> None:
        angles = self._timeline.qpos[row, JOINTS].tolist()
        joints = [JointState(name=name, position=angle) for name, angle in zip(LEG_JOINTS, angles, strict=True)]
        self._log(JointStatesChannel, "/joint_states", row, JointStates(timestamp=self._stamp(row), joints=joints))

    def _write_feet(self, row: int) -> None:
        timeline = self._timeline
        if np.isfinite(timeline.contact_forces_n[row]).all():
            tips, forces = timeline.tips_m[row], timeline.contact_forces_n[row]
            entities = feet_entities(tips, forces, timeline.com_m[row], timeline.zmp_m[row], self._stamp(row))
            self._log_scene("/scene/feet", row, entities)

    def _write_step(self, row: int, step: TimelineStep) -> None:
        """Write what a step does, at its beginning."""
        motion = step.motion
        told: dict[str, Any] = {"step": step.number, "motion": type(motion).__name__.lower()}
        if isinstance(motion, Follow):
            self._log(PosesInFrameChannel, "/path", row, self._poses(motion.waypoints, row))
        elif not isinstance(motion, Reset):
            fields = msgspec.to_builtins(motion)
            told |= {name: value for name, value in fields.items() if name != "kind" and value is not None}
        reward = self._timeline.rewards.get(step.number)
        if reward is not None:
            told["reward"] = reward
        self._log_json("/steps", row, STEP_SCHEMA, told)

    def _write_appeared(self, row: int) -> None:
        """Write all obstacles that have appeared up to a row."""
        tick = self._timeline.tick[row]
        names = {wall_name(each.obstacle) for each in self._timeline.steps[-1].world.appeared if each.tick <= tick}
        stamp = self._stamp(row)
        self._log_scene(
            "/scene/appeared", row, [body_entity(part, stamp) for part in self._parts if part.name in names]
        )

    def _write_plan(self, row: int, planned: PlanAt) -> None:
        place = "box" if isinstance(planned.query, BoxPathQuery) else "trunk"
        plan, stamp = planned.plan, self._stamp(row)
        self._log(PosesInFrameChannel, f"/plan/{place}_path", row, self._poses(plan.waypoints, row))
        if plan.tree is not None and plan.tree.points_m:
            points, parents = np.array(plan.tree.points_m), np.array(plan.tree.parents)
            edges = np.stack([points, points[parents]], axis=1).reshape(-1, 2)
            entity = line_entity(f"{place}_tree", edges, TREE_GREY, stamp, pairs=True)
            self._log_scene(f"/plan/{place}_tree", row, [entity])

    def _write_said(self, row: int, said: Said) -> None:
        status = said.status
        share = "" if status.fraction is None else f" {status.fraction:.0%}"
        waiting = f" (waiting for {status.waiting_for})" if status.waiting_for else ""
        log = Log(
            timestamp=self._stamp(row),
            level=LogLevel.Warning if status.waiting_for else LogLevel.Info,
            message=f"{status.phase}{share} {status.detail}".rstrip() + waiting,
            name=f"{said.origin.role}/{said.origin.name}",
        )
        self._log(LogChannel, "/log", row, log)

    def _poses(self, waypoints: Sequence[Pose2], row: int) -> PosesInFrame:
        poses = [
            pose(np.array([at.x_m, at.y_m, 0.0]), np.array([np.cos(at.yaw_rad / 2), 0.0, 0.0, np.sin(at.yaw_rad / 2)]))
            for at in waypoints
        ]
        return PosesInFrame(timestamp=self._stamp(row), frame_id=WORLD, poses=poses)

    def _log_scene(self, topic: str, row: int, entities: Sequence[Any]) -> None:
        self._log(SceneUpdateChannel, topic, row, SceneUpdate(entities=list(entities)))

    def _log_json(self, topic: str, row: int, schema: dict[str, Any], message: dict[str, Any]) -> None:
        def channel(name: str, *, context: foxglove.Context) -> foxglove.Channel:
            return foxglove.Channel(name, schema=schema, context=context)

        self._log(channel, topic, row, json.dumps(message, allow_nan=False))

    def _log(self, channel: Callable[..., Any], topic: str, row: int, message: object) -> None:
        if topic not in self._channels:
            self._channels[topic] = channel(topic, context=self._context)
        self._channels[topic].log(message, log_time=self.time_ns(row))
        self.n_messages += 1


def _transforms(frames: Sequence[Frame], row: int, stamp: Timestamp) -> FrameTransforms:
    return FrameTransforms(
        transforms=[
            FrameTransform(
                timestamp=stamp,
                parent_frame_id=frame.parent,
                child_frame_id=frame.name,
                translation=vector(frame.positions_m[min(row, len(frame.positions_m) - 1)]),
                rotation=quaternion(frame.quaternions_wxyz[min(row, len(frame.quaternions_wxyz) - 1)]),
            )
            for frame in frames
        ]
    )
