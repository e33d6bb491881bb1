"""Lists what is damaged in a recording, for people."""

from legpush.recording.mcap_file.contents import Recorded, Recording

N_NAMED = 3
"""Most messages of a topic that are named one by one."""


def damage_of(recording: Recording) -> list[str]:
    """Return everything that is damaged, each with its place; empty if nothing is."""
    by_topic: dict[str, list[Recorded]] = {}
    for message in recording.damaged_messages():
        by_topic.setdefault(message.topic, []).append(message)
    found = [_of_topic(recording, topic, messages) for topic, messages in by_topic.items()]
    found += [f"the file {name}" for name in sorted(recording.damaged_attachments)]
    found += recording.damaged_records
    if recording.n_lost:
        found.append(f"{_count(recording.n_lost, 'message')} that cannot be read any more")
    return found


def _of_topic(recording: Recording, topic: str, messages: list[Recorded]) -> str:
    places = []
    for message in messages[:N_NAMED]:
        mark = recording.mark(message)
        step = f", step {mark.place[1]}" if mark is not None and mark.place is not None else ""
        places.append(f"{message.origin.role} {message.origin.name}, sequence {message.copy.sequence}{step}")
    if len(messages) > N_NAMED:
        places.append("...")
    return f"{_count(len(messages), 'message')} of {topic} ({'; '.join(places)})"


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"
