"""A page that is served with its guard."""

from collections.abc import Iterator

import pytest

from tests.sim.view.guarded import Served, serve


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    made = serve("127.0.0.1")
    yield made
    made.server.stop()
