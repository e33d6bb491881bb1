"""`legpush info`: describes a recording for people."""

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import msgspec

from legpush.errors import RecordingError
from legpush.policy_names import runs_code
from legpush.recording.damage import damage_of
from legpush.recording.episodes import read_episodes
from legpush.recording.facts import CONTINUED, MISSION_FILE, read_facts, recorded_with
from legpush.recording.mcap_file.contents import Recording
from legpush.scene.conventions import CONTROL_PERIOD_S


def lines(recording: Recording) -> Iterator[str]:
    """Yield the description, line by line."""
    paths = recording.files
    times = [message.copy.time_ns for message in recording.messages]
    duration_s = (max(times) - min(times)) / 1e9 if times else 0.0
    size = sum(path.stat().st_size for path in paths)
    about = recording.about
    yield f"{', '.join(map(str, paths))}: run {about.get('run', '?')}, protocol {about.get('protocol', '?')}"
    yield f"duration      {duration_s:.1f} s"
    yield (
        f"size          {size / 1e6:.1f} MB in {len(paths)} files"
        if len(paths) > 1
        else (f"size          {size / 1e6:.1f} MB")
    )
    yield f"messages      {len(recording.messages)}"
    yield from _completeness(recording)
    if CONTINUED in about:
        yield "began         after an interruption: steps from before are done again, plans from before are not in it"
    if about.get("topics"):
        yield f"filter        {about['topics']}"
    if "parent_sha256" in about:
        yield (
            f"parent        {about.get('parent_file', '?')} (SHA-256 {about['parent_sha256'][:16]}...), branched at "
            f"episode {about.get('parent_episode')}, step {about.get('parent_step')}"
        )
    yield from _policy(recording)
    yield from _numerics(recording)
    yield from _result(recording)
    yield "channels"
    yield from _channels(recording, duration_s)
    yield "episodes"
    yield from _episodes(recording)
    if recording.attachments:
        yield "files"
        for attachment in recording.attachments.values():
            state = "  DAMAGED" if attachment.name in recording.damaged_attachments else ""
            yield f"  {attachment.name:<28}{len(attachment.data):>9} bytes  {attachment.media_type}{state}"


def facts_of(recording: Recording) -> dict[str, Any]:
    """Return the description as plain data; what cannot be read is None."""
    times = [message.copy.time_ns for message in recording.messages]
    return {
        "files": recording.files,
        "about": recording.about,
        "duration_s": (max(times) - min(times)) / 1e9 if times else 0.0,
        "n_bytes": sum(path.stat().st_size for path in recording.files),
        "n_messages": len(recording.messages),
        "completeness": recording.completeness,
        "damage": list(map(str, damage_of(recording))),
        "mission": _readable(lambda: read_facts(recording)) if recording.attachment(MISSION_FILE) else None,
        "computed_with": _readable(lambda: recorded_with(recording)),
        "report": _readable(lambda: _report(recording)),
        "channels": Counter(message.topic for message in recording.messages),
        "episodes": [
            {
                "episode": episode.index,
                "sim": episode.sim,
                "number": episode.number,
                "n_steps": len(episode.carried_out()),
                "damage": [{"step": each.step, "field": each.field} for each in episode.damage],
            }
            for episode in read_episodes(recording)
        ],
        "attachments": {each.name: len(each.data) for each in recording.attachments.values()},
    }


def _readable(read: Callable[[], Any]) -> Any:
    """Return what can be read, and None for what is damaged."""
    try:
        return read()
    except (RecordingError, msgspec.DecodeError, UnicodeDecodeError):
        return None


def _report(recording: Recording) -> dict[str, Any] | None:
    report = recording.attachment("report.json")
    return None if report is None else msgspec.json.decode(report.data, type=dict[str, Any])


def _completeness(recording: Recording) -> Iterator[str]:
    stated = recording.completeness
    word = {"yes": "yes", "no": "no"}.get(stated.get("complete", ""), "unknown: its recorder did not finish")
    word = "no" if recording.n_lost else word
    missing = stated.get("n_missing", "0")
    yield f"complete      {word}" + (f", {missing} messages missing" if missing != "0" else "")
    for note in filter(None, stated.get("notes", "").splitlines()):
        yield f"              {note}"
    for each in damage_of(recording):
        yield f"              damaged: {each}"


def _policy(recording: Recording) -> Iterator[str]:
    try:
        if recording.attachment(MISSION_FILE) is None:
            return
        facts = read_facts(recording)
    except RecordingError as error:
        yield f"policy        cannot be read: {error}"
        return
    sha256 = f"SHA-256 {facts.policy_sha256[:16]}..." if facts.policy_sha256 else "without files"
    yield f"policy        {facts.policy}, {sha256}"
    if runs_code(facts.policy):
        yield "              it runs code: branch and replay use it only if you repeat it with --policy"


def _numerics(recording: Recording) -> Iterator[str]:
    try:
        recorded = recorded_with(recording)
    except RecordingError as error:
        yield f"numerics      cannot be read: {error}"
        return
    yield f"numerics      {recorded.numerics or 'not noted'}"
    yield f"motions       {'not noted' if recorded.motions is None else f'version {recorded.motions}'}"
    if other := recorded.other_version():
        yield f"              {other}"


def _result(recording: Recording) -> Iterator[str]:
    try:
        numbers = _report(recording)
        if numbers is None:
            yield "result        none recorded"
            return
    except (RecordingError, msgspec.DecodeError, UnicodeDecodeError):
        yield "result        cannot be read: report.json is damaged"
        return
    yield f"result        {numbers.get('reason')}: {numbers.get('detail')}"


def _channels(recording: Recording, duration_s: float) -> Iterator[str]:
    counts: dict[tuple[str, str, str], int] = {}
    for message in recording.messages:
        key = (message.topic, message.origin.role, message.origin.incarnation)
        counts[key] = counts.get(key, 0) + 1
    for (topic, role, incarnation), n in counts.items():
        rate = f"{n / duration_s:8.1f} /s" if duration_s > 0.0 else ""
        yield f"  {topic:<28}{n:>9} messages {rate}  {role} {incarnation}"


def _episodes(recording: Recording) -> Iterator[str]:
    for episode in read_episodes(recording):
        done = episode.carried_out()
        last = done[-1].outcome if done else None
        seconds = f", {last.world.tick * CONTROL_PERIOD_S:.1f} s simulated, state {last.state_crc:08x}" if last else ""
        steps = f"steps 0 to {len(done) - 1}" if done else "no step that was answered"
        yield f"  {episode.index:<4}simulator {episode.sim}: {steps}{seconds} (number {episode.number})"
        for damage in episode.damage:
            yield f"      step {damage.step}: its {damage.field} cannot be used: got {damage.got}"
