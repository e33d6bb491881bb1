"""What the user of a host lets its workers run for heads elsewhere."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from legpush.policy_names import names_code
from legpush.study.jobs import Job


@dataclass(frozen=True)
class Trusted:
    """Code that the workers of this host may run besides that of the installed package."""

    cell: str | None = None
    policies: tuple[str, ...] = ()
    """Names of policies, and of other plug-ins of other packages."""

    def objection(self, job: Job) -> str | None:
        """Return why a job is not run here; None if it may be."""
        if ":" in job.kind and job.kind != self.cell:
            return f"expected cells of an installed kind, or --cell {job.kind} with `legpush study work`"
        for task in job.tasks:
            if task.folder is not None:
                return "expected cells that keep no work in a folder, which only their own machine has"
            for text in texts(task.specification):
                if text not in self.policies and names_code(text):
                    return f"expected cells that are data alone, or --policy {text} with `legpush study work`"
        return None


def texts(value: Any) -> Iterator[str]:
    """Yield all texts in plain values, with the names of fields, such as those of the terms of a task."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for name, each in value.items():
            yield from texts(name)
            yield from texts(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from texts(each)
