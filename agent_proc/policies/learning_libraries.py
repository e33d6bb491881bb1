"""Says which extra installs the libraries of learning, where one of them is imported and missing."""

from collections.abc import Iterator
from contextlib import contextmanager

from legpush.errors import PolicyError


@contextmanager
def learning_libraries(what: str) -> Iterator[None]:
    """Surround an import of the learning libraries, which `what` needs.

    Raises:
        PolicyError: One of them is not installed; names it, and the extra that installs it.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        raise PolicyError(
            f"Expected the learning libraries for {what}, but {error.name} is not installed; "
            "pip install 'legpush[train]' installs them"
        ) from error
