"""Reads the plans of a recording: each query with its answers."""

from dataclasses import dataclass, field

import msgspec

from legpush.errors import MessageError, RecordingError
from legpush.messages import codec
from legpush.messages.planning import Plan, PlanQuery, PlanRequest, PlanResult
from legpush.recording.mcap_file.contents import Recording


@dataclass(kw_only=True)
class RecordedPlans:
    """A query and the revisions of its answer."""

    client: str
    request_id: int
    query: PlanQuery
    plans: dict[int, Plan] = field(default_factory=dict)


def read_plans(recording: Recording) -> list[RecordedPlans]:
    """Return every query that was answered, in the order of the requests.

    Raises:
        RecordingError: A message is damaged.
    """
    records: dict[tuple[str, int], RecordedPlans] = {}
    results: list[PlanResult] = []
    for message in recording.messages:
        if message.topic.startswith("plan/") and message.topic.endswith(("/request", "/result")):
            if not recording.is_as_recorded(message):
                raise RecordingError(f"{message.place}: its bytes are not those that were recorded")
            try:
                if message.topic.endswith("/request"):
                    request = codec.decode(message.copy.payload, PlanRequest)
                    key = (request.header.incarnation, request.request_id)
                    name = request.header.name
                    records.setdefault(key, RecordedPlans(client=name, request_id=key[1], query=request.query))
                else:
                    results.append(codec.decode(message.copy.payload, PlanResult))
            except MessageError as error:
                raise RecordingError(f"{message.place}: {error}") from error
    for result in results:
        record = records.get((result.client_incarnation, result.request_id))
        if record is not None:
            record.plans.setdefault(result.revision, result.plan)
    return [record for record in records.values() if 0 in record.plans]


def query_bytes(query: PlanQuery) -> bytes:
    """Return bytes that are the same for equal queries."""
    return msgspec.msgpack.encode(query)
