"""Where tests run in parallel, slow files come first; quick ones fill the time of the processes that are done early."""

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests of whole missions first, if this is one of several processes."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: "system" not in item.path.parts)
