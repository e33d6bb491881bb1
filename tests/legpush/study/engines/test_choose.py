import pytest

from legpush.errors import ConfigError
from legpush.study.engines.choose import make_engine, require_engine


def test_an_engine_is_found_by_its_name() -> None:
    require_engine("local")
    engine = make_engine("local", 3)
    assert (engine.name, engine.n_slots()) == ("local", 3)
    engine.close(now=True)


def test_an_unknown_engine_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(ConfigError, match="Expected local for --on, got 'cluster'"):
        make_engine("cluster", 1)
