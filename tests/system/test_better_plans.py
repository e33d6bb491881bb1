"""Plans that get better while time remains, over the bus: in order, whatever the channel does, and until cancelled."""

from collections.abc import Iterator
from pathlib import Path
from threading import Event

import pytest
from msgspec.structs import replace

from legpush.bus.faults import Faults
from legpush.errors import JournalError
from legpush.history.journal import Journal
from legpush.history.steps import PlanRecord, read_episode
from legpush.lockstep.episode import Episode
from legpush.messages.planning import Plan, PlanQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from legpush.scene.plan_settings import Anytime
from tests.legpush.examples import QUERY
from tests.legpush.fakes import agent, eventually, fake_plan, opened, planner, sim

N = 5
ASKED = replace(QUERY, anytime=Anytime(n_improvements=N, improvement_iterations=10))


def better(query: PlanQuery, revision: int) -> Plan:
    return replace(fake_plan(query), length_m=10.0 - revision)


def improving(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
    """A metre shorter each time."""
    for k in range(N + 1):
        if interrupted():
            raise PlanningInterruptedError
        yield better(query, k)


class Endless:
    """Finds a first plan and then works on, until it is interrupted."""

    def __init__(self) -> None:
        self.began, self.stopped = Event(), Event()

    def __call__(self, query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        if query.seed == 1:
            yield fake_plan(query)
            return
        yield better(query, 0)
        self.began.set()
        while not interrupted():
            self.stopped.wait(0.005)
        self.stopped.set()
        raise PlanningInterruptedError


def test_every_revision_arrives_whatever_the_channel_does(tmp_path: Path) -> None:
    faults = Faults(probability=0.3, seed=4)
    with planner(tmp_path, faults=faults, make_plans=improving), agent(tmp_path, faults) as asking:
        assert asking.planner.plan(ASKED) == better(ASKED, 0)
        for revision in (1, 2, 4):
            assert asking.planner.revision(revision, ASKED) == better(ASKED, revision)


def test_after_the_last_revision_there_is_none_but_that(tmp_path: Path) -> None:
    with planner(tmp_path, make_plans=improving), agent(tmp_path) as asking:
        asking.planner.plan(ASKED)
        assert asking.planner.revision(N + 3, ASKED) == better(ASKED, N)
    with planner(tmp_path), agent(tmp_path) as asking:
        asking.planner.plan(QUERY)
        assert asking.planner.revision(2, QUERY) == fake_plan(QUERY)


def test_an_agent_that_comes_back_is_given_the_revision_that_it_waited_for(tmp_path: Path) -> None:
    with planner(tmp_path, make_plans=improving):
        with agent(tmp_path) as first:
            first.planner.plan(ASKED)
        with agent(tmp_path) as second:
            assert second.planner.revision(3, ASKED) == better(ASKED, 3)


def test_a_planner_stops_working_when_it_is_cancelled_and_answers_the_next_request(tmp_path: Path) -> None:
    endless = Endless()
    with planner(tmp_path, make_plans=endless), agent(tmp_path) as asking:
        asking.planner.plan(ASKED)
        assert endless.began.wait(10.0)
        assert not endless.stopped.is_set()
        asking.planner.cancel()
        assert endless.stopped.wait(10.0)
        assert asking.planner.plan(replace(QUERY, seed=1)) == fake_plan(replace(QUERY, seed=1))


def test_a_newer_request_of_the_client_takes_the_place_of_improvements(tmp_path: Path) -> None:
    endless = Endless()
    with planner(tmp_path, make_plans=endless), agent(tmp_path) as asking:
        asking.planner.plan(ASKED)
        assert endless.began.wait(10.0)
        asking.planner.plan(replace(QUERY, seed=1))
        assert eventually(endless.stopped.is_set)


def revisions_of(directory: Path, journal_path: Path, revisions: tuple[int, ...]) -> list[Plan]:
    """A plan and better ones, as a mission asks for them."""
    with agent(directory) as asking, Journal(journal_path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        return [episode.plan(ASKED), *(episode.revision(revision) for revision in revisions)]


def test_better_plans_are_answered_by_the_journal_as_far_as_that_goes(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    expected = [better(ASKED, revision) for revision in (0, 1, 3, 4)]
    with sim(tmp_path), planner(tmp_path, make_plans=improving):
        assert revisions_of(tmp_path, path, (1, 3)) == expected[:3]
        assert revisions_of(tmp_path, path, (1, 3, 4)) == expected
    assert revisions_of(tmp_path, path, (1, 3, 4)) == expected
    assert [record.plan for record in read_episode(path) if isinstance(record, PlanRecord)] == expected


def test_a_mission_that_asks_for_another_revision_than_its_journal_has_is_told(tmp_path: Path) -> None:
    path = tmp_path / "episode-0000.journal"
    with sim(tmp_path), planner(tmp_path, make_plans=improving):
        revisions_of(tmp_path, path, (1,))
        with pytest.raises(JournalError, match="the journal is of another mission"):
            revisions_of(tmp_path, path, (2,))


def test_what_is_there_already_is_answered_without_a_planner(tmp_path: Path) -> None:
    with agent(tmp_path) as asking:
        with planner(tmp_path, make_plans=improving):
            asking.planner.plan(ASKED)
            assert asking.planner.revision(N, ASKED) == better(ASKED, N)
        for revision in range(1, N + 1):
            assert asking.planner.revision(revision, ASKED) == better(ASKED, revision)
