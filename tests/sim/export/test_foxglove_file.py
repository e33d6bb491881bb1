"""What Foxglove reads is what was recorded: decoded by the schemas in its file, and compared with the timeline."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader

from legpush.history.timeline import BOX, JOINTS, TRUNK, Timeline
from legpush.scene.conventions import LEGS
from sim_proc.export.columns import columns_of
from sim_proc.export.foxglove_file import write_foxglove
from sim_proc.export.source import Source
from sim_proc.model.world import build_model
from tests.sim.export.foxglove_reading import Read, read

QUATERNION = ("w", "x", "y", "z")


@pytest.fixture(scope="module")
def exported(source: Source, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("foxglove") / "a.mcap"
    write_foxglove(source, source.episodes[0], {"source": "a.mcap"}, path, lambda done, of: None)
    return path


@pytest.fixture(scope="module")
def messages(exported: Path) -> list[Read]:
    return read(exported)


@pytest.fixture
def timeline(source: Source) -> Timeline:
    return source.episodes[0].timeline


def under(messages: list[Read], topic: str) -> list[Any]:
    found = [message.content for message in messages if message.topic == topic]
    assert found, f"nothing under {topic}"
    return found


def numbers(message: Any, names: tuple[str, ...] = ("x", "y", "z")) -> list[float]:
    return [getattr(message, name) for name in names]


def frames(transforms: Any) -> dict[str, tuple[str, list[float], list[float]]]:
    """Parent, translation and quaternion (w, x, y, z) by frame."""
    return {
        each.child_frame_id: (each.parent_frame_id, numbers(each.translation), numbers(each.rotation, QUATERNION))
        for each in transforms.transforms
    }


def test_trunk_and_box_are_where_they_were_at_every_tick_bit_for_bit(messages: list[Read], timeline: Timeline) -> None:
    ticks = [frames(each) for each in under(messages, "/tf")]
    for name, columns in (("trunk", TRUNK), ("box", BOX)):
        poses = np.array([[*each[name][1], *each[name][2]] for each in ticks])
        assert {each[name][0] for each in ticks} == {"world"}
        np.testing.assert_array_equal(poses, timeline.qpos[:, columns])


def test_every_link_is_where_mujoco_has_it(messages: list[Read], timeline: Timeline) -> None:
    model = build_model(timeline.scenario)
    data = mujoco.MjData(model)
    standing = frames(under(messages, "/tf_static")[0])
    compared = 0
    for row, transforms in list(enumerate(under(messages, "/tf")))[::40]:
        data.qpos[:] = timeline.qpos[row]
        mujoco.mj_kinematics(model, data)
        tree = {**standing, **frames(transforms)}
        for name in tree:
            rotation, position, at = np.eye(3), np.zeros(3), name
            while at != "world":
                parent, translation, quaternion = tree[at]
                turn = np.empty(9)
                mujoco.mju_quat2Mat(turn, np.array(quaternion))
                rotation, position = turn.reshape(3, 3) @ rotation, turn.reshape(3, 3) @ position + translation
                at = parent
            body = data.body(name)
            np.testing.assert_allclose(position, body.xpos, atol=1e-12)
            np.testing.assert_allclose(rotation.ravel(), body.xmat, atol=1e-12)
            compared += 1
    assert compared > 5 * 15


def test_joint_states_are_the_recorded_angles_by_name(messages: list[Read], timeline: Timeline) -> None:
    states = under(messages, "/joint_states")
    assert [joint.name for joint in states[0].joints] == [
        f"{leg}_{joint}" for leg in LEGS for joint in ("hip_x", "hip_y", "knee")
    ]
    angles = np.array([[joint.position for joint in state.joints] for state in states])
    np.testing.assert_array_equal(angles, timeline.qpos[:, JOINTS])


def test_times_are_the_beginning_of_the_episode_plus_simulated_time(messages: list[Read], timeline: Timeline) -> None:
    times = [message.time_ns for message in messages if message.topic == "/tf"]
    began = timeline.steps[0].time_ns
    assert times == [began + int(tick) * 20_000_000 for tick in timeline.tick]
    stamps = [each.transforms[0].timestamp for each in under(messages, "/tf")]
    assert [stamp.seconds * 10**9 + stamp.nanos for stamp in stamps] == times


def test_signals_are_the_columns_of_the_table_and_keep_their_schema(exported: Path, source: Source) -> None:
    with exported.open("rb") as file:
        schema = next(s for s, channel, _ in make_reader(file).iter_messages() if s and channel.topic == "/signals")
    signals = under(read(exported), "/signals")
    columns = {column.name: column.values.tolist() for column in columns_of(source.episodes[:1])}
    assert len(signals) == len(columns["tick"])
    described = json.loads(schema.data)
    assert described["properties"]["force_FL_z_w_n"]["description"].endswith("[N]")
    for row, signal in enumerate(signals):
        for name in described["properties"]:
            value = columns[name][row]
            assert signal.get(name) == (value if value == value else None)
        jsonschema.validate(signal, described)


def test_the_scene_has_every_shape_of_the_model_once(messages: list[Read], timeline: Timeline) -> None:
    model = build_model(timeline.scenario)
    topics = ("/scene/room", "/scene/robot", "/scene/box")
    entities = [entity for topic in topics for update in under(messages, topic) for entity in update.entities]
    assert sorted(entity.id for entity in entities) == sorted(
        model.body(body).name for body in range(model.nbody) if model.body(body).name not in ("wall_1", "wall_2")
    )
    assert all(entity.frame_id == entity.id for entity in entities)
    cubes = {entity.id: [numbers(cube.size) for cube in entity.cubes] for entity in entities}
    assert numbers_close(cubes["box"][0], timeline.scenario.box.size_m)
    assert [0.5, 1.0, 0.6] in [np.round(size, 9).tolist() for size in cubes["walls_0"]]
    lower = next(entity for entity in entities if entity.id == "FL_lower")
    assert len(lower.cylinders) == 1
    assert sorted(round(sphere.pose.position.z, 9) for sphere in lower.spheres) == [-0.37, -0.34, 0.0]


def test_every_shape_is_where_mujoco_has_it(messages: list[Read], timeline: Timeline) -> None:
    model = build_model(timeline.scenario)
    data = mujoco.MjData(model)
    data.qpos[:] = timeline.qpos[0]
    mujoco.mj_kinematics(model, data)
    compared, tolerance_m = 0, 0.0051  # the floor is a slab below the plane, half of it
    for topic in ("/scene/room", "/scene/robot", "/scene/box", "/scene/appeared"):
        for entity in under(messages, topic)[0].entities:
            body = data.body(entity.frame_id)
            primitives = [*entity.cubes, *entity.cylinders, *entity.spheres]
            turn = body.xmat.reshape(3, 3)
            places = [turn @ numbers(each.pose.position) + body.xpos for each in primitives]
            for geom in np.flatnonzero(model.geom_bodyid == body.id):
                assert min(float(np.abs(data.geom_xpos[geom] - place).max()) for place in places) < tolerance_m
                compared += 1
    assert compared == model.ngeom - 1


def numbers_close(one: list[float], other: tuple[float, ...]) -> bool:
    return np.allclose(one, other, atol=1e-12)


def test_a_wall_that_appears_is_seen_from_that_tick_on_and_one_that_does_not_never(messages: list[Read]) -> None:
    (update,) = [message for message in messages if message.topic == "/scene/appeared"]
    assert [entity.id for entity in update.content.entities] == ["wall_1"]
    began = next(message.time_ns for message in messages if message.topic == "/tf")
    assert update.time_ns == began + 20 * 20_000_000


def test_arrows_at_the_feet_are_the_contact_forces(messages: list[Read], timeline: Timeline) -> None:
    compared = 0
    updates = under(messages, "/scene/feet")
    assert len(updates) == timeline.n_rows - 1
    for row, update in enumerate(updates, start=1):
        forces, tips = timeline.contact_forces_n[row], timeline.tips_m[row]
        loaded = np.linalg.norm(forces, axis=1) >= 1.0
        arrows = next(entity for entity in update.entities if entity.id == "forces").arrows
        for arrow, force, tip in zip(arrows, forces[loaded], tips[loaded], strict=True):
            assert numbers(arrow.pose.position) == tip.tolist()
            turn = np.empty(9)
            mujoco.mju_quat2Mat(turn, np.array(numbers(arrow.pose.orientation, QUATERNION)))
            along = turn.reshape(3, 3)[:, 0] * arrow.shaft_length / 0.002
            np.testing.assert_allclose(along, force, atol=1e-9)
            compared += 1
    assert compared > timeline.n_rows


def test_paths_plans_trees_steps_and_statuses_are_there(messages: list[Read]) -> None:
    (path,) = under(messages, "/path")
    assert [numbers(each.position) for each in path.poses] == [[2.0, 5.0, 0.0], [1.8, 5.0, 0.0]]
    (plan,) = under(messages, "/plan/trunk_path")
    assert [numbers(each.position) for each in plan.poses] == [[1.0, 2.5, 0.0], [0.1, 0.2, 0.0]]
    (tree,) = under(messages, "/plan/trunk_tree")
    assert len(tree.entities[0].lines[0].points) == 4
    (log,) = under(messages, "/log")
    assert (log.name, log.message) == ("agent/main", "pushing 50% cycle 1")
    steps = under(messages, "/steps")
    assert [step["motion"] for step in steps] == ["reset", "push", "follow", "walk"]
    assert steps[1]["reward"] == 0.1 + 0.2
    assert (steps[1]["leg"], steps[1]["depth_m"]) == ("FL", 0.05)
    (trails,) = under(messages, "/scene/trails")
    assert {entity.id for entity in trails.entities} == {"trunk_trail", "box_trail"}


def test_the_file_says_where_it_comes_from_and_has_the_files_of_the_recording(exported: Path) -> None:
    with exported.open("rb") as file:
        reader = make_reader(file)
        (metadata,) = [each.metadata for each in reader.iter_metadata() if each.name == "legpush"]
        attached = {each.name.rpartition("/")[2]: each.data for each in reader.iter_attachments()}
    assert metadata["source"] == "a.mcap"
    assert "since 1970" in metadata["times"]
    assert attached["report.json"] == b"{}"


def test_the_layout_in_the_docs_names_topics_and_signals_that_exist(messages: list[Read]) -> None:
    panels = json.loads((Path(__file__).parents[3] / "docs" / "foxglove_layout.json").read_text())["configById"]
    shown = {topic for panel in panels.values() for topic in panel.get("topics", ())}
    shown |= {panel["topicToRender"] for panel in panels.values() if "topicToRender" in panel}
    plotted = [path["value"].split(".") for panel in panels.values() for path in panel.get("paths", ())]
    signals = under(messages, "/signals")[1]
    assert "/scene/robot" in shown
    assert shown - {message.topic for message in messages} == {"/plan/box_path", "/plan/box_tree"}
    assert {topic for topic, _ in plotted} == {"/signals"}
    assert {field for _, field in plotted} <= signals.keys()
