"""The plans of a recording: which query got which answers."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.bus import keys
from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.planning import PlanQuery, PlanRequest, PlanResult
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile
from legpush.recording.plans import query_bytes, read_plans
from tests.legpush.examples import BOX_QUERY, PLAN, QUERY
from tests.legpush.fakes import RUN
from tests.legpush.recording.recordings import ABOUT, AGENT, copy, damaged, header

PLANNER = replace(AGENT, role="planner", incarnation="planner-1")
QUERIES: tuple[PlanQuery, ...] = (QUERY, BOX_QUERY, replace(QUERY, seed=5))
REQUESTS = [
    PlanRequest(header=header(AGENT, request_id), request_id=request_id, query=query)
    for request_id, query in enumerate(QUERIES)
]


def result(sequence: int, request_id: int, revision: int, n_iterations: int) -> PlanResult:
    return PlanResult(
        header=header(PLANNER, sequence),
        client_incarnation=AGENT.incarnation,
        request_id=request_id,
        revision=revision,
        final=True,
        plan=replace(PLAN, n_iterations=n_iterations),
    )


def recorded(path: Path, results: Sequence[PlanResult]) -> Recording:
    """A recording with the answers before the requests: each sender has a batch of its own."""
    told = [copy(keys.plan_result(RUN, "main"), each.header.sequence, codec.encode(each)) for each in results]
    asked = [copy(keys.plan_request(RUN, "main"), each.request_id, codec.encode(each)) for each in REQUESTS]
    file = RecordingFile(path, ABOUT)
    file.write(PLANNER, tuple(told))
    file.write(AGENT, (*asked, asked[0]))
    file.finish({})
    return read_recording([path])


def test_queries_come_in_the_order_of_asking_each_with_its_revisions_and_unanswered_ones_are_left_out(
    tmp_path: Path,
) -> None:
    results = [result(0, 2, 0, 10), result(1, 2, 1, 11), result(2, 0, 0, 12), result(3, 0, 0, 13), result(4, 7, 0, 14)]
    found = read_plans(recorded(tmp_path / "a.mcap", results))
    assert [(each.request_id, each.client, each.query) for each in found] == [
        (0, "main", QUERY),
        (2, "main", replace(QUERY, seed=5)),
    ]
    assert [{revision: plan.n_iterations for revision, plan in each.plans.items()} for each in found] == [
        {0: 12},
        {0: 10, 1: 11},
    ]


def test_a_plan_whose_bytes_changed_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    answer = result(0, 0, 0, 10)
    recorded(path, [answer])
    with pytest.raises(RecordingError, match="plan/main/result of planner main, sequence 0: its bytes are not those"):
        read_plans(damaged(path, codec.encode(answer), 60))


def test_equal_queries_have_equal_bytes_and_others_do_not() -> None:
    assert query_bytes(QUERY) == query_bytes(replace(QUERY))
    assert query_bytes(QUERY) != query_bytes(replace(QUERY, seed=5))
