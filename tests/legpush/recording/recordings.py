"""Recordings to test with: an agent and a simulator without a bus between them, and their messages as batches."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from legpush.bus import keys
from legpush.errors import MotionError
from legpush.lockstep.simulator import Stepper
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header, Role
from legpush.messages.stepping import Action, Motion, Observation, Refusal, Reset
from legpush.messages.telemetry import Copies, Copy, Fact, Origin, Published
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import WHOLE, RecordingFile, Split
from legpush.recording.recorder import Recorder, Wanted, statement
from tests.legpush.fakes import RUN, FakeStepper, mission

ABOUT = {"run": RUN, "protocol": str(PROTOCOL_VERSION)}
AGENT = Origin(role="agent", name="main", incarnation="agent-1")
SIM = Origin(role="sim", name="main", incarnation="sim-1")
ACTIONS, ANSWERS = keys.action(RUN, "main"), keys.observation(RUN, "main")
EPISODE = 1700000000000


def header(origin: Origin, sequence: int) -> Header:
    role: Role = origin.role
    return Header(
        protocol=PROTOCOL_VERSION,
        run=RUN,
        role=role,
        name=origin.name,
        incarnation=origin.incarnation,
        sequence=sequence,
    )


def copy(key: str, sequence: int, payload: bytes) -> Copy:
    return Copy(key=key, sequence=sequence, time_ns=1_700_000_000_000_000_000 + sequence * 10_000_000, payload=payload)


def batch(
    origin: Origin, number: int, copies: Sequence[Copy], *, final: bool = False, facts: tuple[Fact, ...] = ()
) -> Copies:
    """A batch whose last copies are the last that were published."""
    published = {each.key: each.sequence + 1 for each in copies}
    since = {each.key: each.sequence for each in reversed(copies)}
    return Copies(
        header=header(origin, number),
        origin=origin,
        batch=number,
        copies=tuple(copies),
        published=tuple(Published(key=key, n=n, since=since[key]) for key, n in published.items()),
        facts=facts,
        final=final,
    )


def traffic(motions: Sequence[Motion], stepper: Stepper | None = None) -> tuple[list[Copy], list[Copy]]:
    """What agent and simulator publish for these motions, one episode for each reset."""
    stepper = stepper or FakeStepper()
    actions: list[Copy] = []
    answers: list[Copy] = []
    step = 0
    for sequence, motion in enumerate(motions):
        action = Action(header=header(AGENT, sequence), episode=EPISODE, step=step, motion=motion, with_trace=True)
        to: dict[str, Any] = {
            "header": header(SIM, sequence),
            "agent_incarnation": AGENT.incarnation,
            "episode": EPISODE,
            "step": step,
        }
        answer: Observation | Refusal
        try:
            answer = Observation(outcome=stepper.perform(motion, with_trace=True), **to)
            step += 1
        except MotionError as error:
            answer = Refusal(cause="invalid", reason=str(error), next_episode=EPISODE, next_step=step, **to)
        actions.append(copy(ACTIONS, sequence, codec.encode(action)))
        answers.append(copy(ANSWERS, sequence, codec.encode(answer)))
    return actions, answers


def write(
    path: Path,
    actions: Sequence[Copy],
    answers: Sequence[Copy],
    *,
    split: Split = WHOLE,
    n_per_batch: int = 5,
    facts: tuple[Fact, ...] = (),
    says_farewell: bool = True,
) -> list[Path]:
    """A recording of these messages, flushed after every batch; its files."""
    file = RecordingFile(path, ABOUT, split)
    recorder = Recorder(file, Wanted())
    for number, begin in enumerate(range(0, max(len(actions), 1), n_per_batch)):
        end = begin + n_per_batch
        for origin, copies in ((AGENT, actions), (SIM, answers)):
            recorder.write_batch(
                batch(origin, number, copies[begin:end], final=says_farewell and end >= len(copies), facts=facts)
            )
        file.flush()
    file.finish(statement(recorder.ledger.completeness()))
    return file.parts


def a_recording(path: Path, motions: Sequence[Motion] | None = None) -> Path:
    """Of a fake mission."""
    write(path, *traffic(mission() if motions is None else motions))
    return path


def beyond_the_bounds(path: Path) -> Path:
    """Of a fake mission whose box is heavier than a valid message says; a version without that bound wrote it."""
    reset, *others = mission()
    assert isinstance(reset, Reset)
    box = replace(reset.scenario.box, mass_kg=2000.0)
    return a_recording(path, [replace(reset, scenario=replace(reset.scenario, box=box)), *others])


def damaged(path: Path, at: bytes, shift: int = 0) -> Recording:
    """The recording, after a bit has flipped where these bytes begin, or beyond."""
    data = bytearray(path.read_bytes())
    data[data.index(at) + shift] ^= 1
    path.write_bytes(data)
    return read_recording([path])
