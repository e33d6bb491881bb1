"""A whole mission with the real processes: it succeeds, and a bad channel or another simulator ends in equal states."""

from pathlib import Path

from legpush.history.steps import StepRecord, read_episode
from legpush.messages.common import Role
from sim_proc.simulator import Simulator
from tests.system.conftest import ThoroughMission
from tests.system.missions import crc_of, do_mission, report_of, running_mission

ROLES: tuple[Role, ...] = ("planner", "sim", "agent")


def test_the_mission_succeeds_within_its_numbers(thorough_mission: ThoroughMission) -> None:
    report = report_of(thorough_mission.out)
    assert report["success"]
    assert report["box_position_error_m"] <= 0.03
    assert report["box_angle_error_deg"] <= 3.0
    assert report["walk_tracking_rms_m"] <= 0.05
    assert max(report["trunk_max_abs_pitch_deg"], report["trunk_max_abs_roll_deg"]) <= 5.0
    assert report["min_support_margin_m"] > 0.0
    assert report["handover_distance_m"] <= 3.0
    assert report["n_push_cycles"] > 0
    assert (thorough_mission.out / "mission.png").stat().st_size > 50_000


def test_the_recorded_motions_lead_a_simulator_in_this_process_to_the_same_states(
    thorough_mission: ThoroughMission,
) -> None:
    simulator = Simulator()
    n_steps = 0
    for record in read_episode(thorough_mission.out / "episode-0000.journal"):
        if isinstance(record, StepRecord):
            outcome = simulator.perform(record.motion, with_trace=record.outcome.trace is not None)
            assert outcome == record.outcome
            n_steps += 1
    assert n_steps > 30
    assert f"{outcome.state_crc:08x}" == crc_of(thorough_mission.out)


def test_a_channel_that_drops_duplicates_delays_and_reorders_changes_nothing(
    thorough_mission: ThoroughMission, tmp_path: Path
) -> None:
    out = tmp_path / "run"
    do_mission(out, *thorough_mission.flags, "--inject-faults", "0.2")
    assert crc_of(out) == crc_of(thorough_mission.out)
    logs = "".join((out / "logs" / f"{role}.log").read_text() for role in ROLES)
    assert "'late'" in logs


def test_no_process_is_large_and_only_the_agent_may_load_torch(
    thorough_mission: ThoroughMission, tmp_path: Path
) -> None:
    largest = dict.fromkeys(ROLES, 0)
    torch: set[Role] = set()
    with running_mission(tmp_path / "run", *thorough_mission.flags) as mission:
        mission.wait_for("pushing")
        for role in ROLES:
            process = mission.process(role)
            largest[role] = process.memory_info().rss
            if any("torch" in region.path for region in process.memory_maps()):
                torch.add(role)
        mission.output()
    assert largest["sim"] < 250e6
    assert largest["planner"] < 250e6
    assert largest["agent"] < 500e6
    assert min(largest.values()) > 10e6
    assert torch <= {"agent"}
