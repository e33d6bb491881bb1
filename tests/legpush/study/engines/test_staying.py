from legpush.study.engines.inline import InlineEngine
from legpush.study.engines.staying import staying


class Counted(InlineEngine):
    def __init__(self) -> None:
        self.closed: list[bool] = []

    def close(self, *, now: bool) -> None:
        self.closed.append(now)


def test_an_engine_stays_when_a_study_is_done_and_ends_when_one_is_stopped_or_all_are_done() -> None:
    engine = Counted()
    with staying(engine) as stays:
        assert (stays.name, stays.pace, stays.n_slots()) == (engine.name, engine.pace, 1)
        stays.close(now=False)
        assert engine.closed == []
        stays.close(now=True)
        assert engine.closed == [True]
    assert engine.closed == [True, False]
