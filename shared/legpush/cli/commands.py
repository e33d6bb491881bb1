"""The table of all commands of `legpush`: their options, and the programs that some of them become."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass
from difflib import get_close_matches
from functools import reduce
from operator import or_
from typing import Annotated, Any, Final

from legpush.arguments import subcommand
from legpush.authority.options import AddHosts, BeginAuthority, RenewCertificates, RevokeCertificates, ShowCertificates
from legpush.errors import ConfigError
from legpush.options.bench import ListFaults, SoakOptions
from legpush.options.conformance import PlanCheckOptions
from legpush.options.export import ExportOptions, RenderOptions
from legpush.options.learning import CalibrateOptions, EvaluateOptions, TrainOptions
from legpush.options.learning_tools import CompareOptions, CurvesOptions, TuneOptions
from legpush.options.maps import MapOptions, PictureOptions
from legpush.options.numerics import CanaryOptions, KernelOptions, PythonOptions
from legpush.options.policies import ExportPolicy, ShowPolicy
from legpush.options.recordings import BranchOptions, InfoOptions, RecordOptions, RecoverOptions, ReplayOptions
from legpush.options.run import RouterOptions, RunOptions
from legpush.options.scenarios import (
    CopyExamples,
    CopyScenario,
    ListExamples,
    ListScenarios,
    RandomScenario,
    ShowScenario,
)
from legpush.options.shell import CompletionOptions, DoctorOptions, HealthOptions
from legpush.options.study import MergeStudies, RunStudy, StudyStatus, StudyTable, VerifyStudy, WorkOptions
from legpush.options.view import ViewOptions
from legpush.processes.start_program import Program


@dataclass(frozen=True)
class Group:
    """Commands that share their first word."""

    what: str
    """What they do, for `legpush --help`."""
    commands: Mapping[str, type]
    """Their options, by their second word."""


COMMANDS: Final[Mapping[str, type | Group]] = {
    "run": RunOptions,
    "train": TrainOptions,
    "evaluate": EvaluateOptions,
    "compare": CompareOptions,
    "curves": CurvesOptions,
    "tune": TuneOptions,
    "calibrate": CalibrateOptions,
    "scenarios": Group(
        "List, show, copy or draw scenarios.",
        {"list": ListScenarios, "show": ShowScenario, "copy": CopyScenario, "random": RandomScenario},
    ),
    "examples": Group("List or copy the examples.", {"list": ListExamples, "copy": CopyExamples}),
    "map": MapOptions,
    "policy": Group("Show or export a trained policy.", {"show": ShowPolicy, "export": ExportPolicy}),
    "render": RenderOptions,
    "picture": PictureOptions,
    "record": RecordOptions,
    "info": InfoOptions,
    "recover": RecoverOptions,
    "replay": ReplayOptions,
    "branch": BranchOptions,
    "export": ExportOptions,
    "view": ViewOptions,
    "study": Group(
        "Run a study, work for one, look at it, check it, or put several together.",
        {
            "run": RunStudy,
            "work": WorkOptions,
            "status": StudyStatus,
            "table": StudyTable,
            "verify": VerifyStudy,
            "merge": MergeStudies,
        },
    ),
    "bench": Group(
        "Measure how missions and trainings stand what goes wrong.", {"soak": SoakOptions, "faults": ListFaults}
    ),
    "secure": Group(
        "Make, add, renew, revoke or list the certificates with which hosts talk to each other.",
        {
            "init": BeginAuthority,
            "add": AddHosts,
            "renew": RenewCertificates,
            "revoke": RevokeCertificates,
            "show": ShowCertificates,
        },
    ),
    "router": RouterOptions,
    "health": HealthOptions,
    "plan-check": PlanCheckOptions,
    "doctor": DoctorOptions,
    "canary": CanaryOptions,
    "python": PythonOptions,
    "kernel": KernelOptions,
    "completion": CompletionOptions,
}
"""All commands, in the order of `legpush --help`."""

PROGRAMS: Final[Mapping[type, tuple[Program, *tuple[str, ...]]]] = {
    TrainOptions: ("agent_proc.programs.train",),
    EvaluateOptions: ("agent_proc.programs.evaluate",),
    CompareOptions: ("agent_proc.programs.compare",),
    CurvesOptions: ("agent_proc.programs.curves",),
    TuneOptions: ("agent_proc.programs.tune",),
    CalibrateOptions: ("agent_proc.programs.calibrate",),
    RandomScenario: ("agent_proc.programs.draw_room",),
    MapOptions: ("agent_proc.programs.show_map",),
    PictureOptions: ("agent_proc.programs.draw_mission",),
    ShowPolicy: ("agent_proc.programs.policy", "show"),
    ExportPolicy: ("agent_proc.programs.policy", "export"),
    ExportOptions: ("sim_proc.export.program",),
    ViewOptions: ("sim_proc.view.program",),
    StudyTable: ("agent_proc.programs.study_table",),
    PlanCheckOptions: ("planner_proc.conformance.program",),
    CanaryOptions: ("legpush.canary",),
}
"""Programs that run in a process of their own, by the options of their command. They parse the same arguments, after
the words that are given here."""


@dataclass(frozen=True)
class Line:
    """A command line whose command is known."""

    command: str
    """The words of the command, such as `scenarios show`."""
    options: type
    arguments: tuple[str, ...]
    """What follows the command."""


def find_command(argv: Sequence[str]) -> Line | Group | None:
    """Return the command of a command line; the group if help about it is asked for, and None for help about all.

    Raises:
        ConfigError: There is no such command; names the nearest one.
    """
    if not argv or argv[0] in ("-h", "--help"):
        return None
    found = _look_up(COMMANDS, argv[0], "a command")
    if not isinstance(found, Group):
        return Line(argv[0], found, tuple(argv[1:]))
    if argv[1:2] in ([], ["-h"], ["--help"]):
        return found
    options = _look_up(found.commands, argv[1], f"what `legpush {argv[0]}` does")
    return Line(" ".join(argv[:2]), options, tuple(argv[2:]))


def _look_up(table: Mapping[str, Any], word: str, what: str) -> Any:
    if word in table:
        return table[word]
    nearest = get_close_matches(word, table, n=1)
    hint = f" (did you mean `{nearest[0]}`?)" if nearest else ""
    raise ConfigError(f"Expected {what} ({', '.join(table)}), got `{word}`{hint}")


def all_commands() -> dict[str, type]:
    """Return the options of all commands by their words, such as `scenarios show`."""
    found: dict[str, type] = {}
    for name, entry in COMMANDS.items():
        if isinstance(entry, Group):
            found |= {f"{name} {word}": kind for word, kind in entry.commands.items()}
        else:
            found[name] = entry
    return found


def choice_of(table: Mapping[str, type | Group]) -> Any:
    """Return a type that stands for a choice of these commands, for their help and for completion."""
    return reduce(or_, (_member(name, entry) for name, entry in table.items()))


def _member(name: str, entry: type | Group) -> Any:
    if isinstance(entry, Group):
        return Annotated[_grouped(entry), subcommand(name, entry.what)]
    return Annotated[entry, subcommand(name, first_sentence(entry))]


def _grouped(group: Group) -> type:
    """Return a record whose one field is a choice of the commands of a group."""
    return make_dataclass("Choice", [("action", choice_of(group.commands))], frozen=True)


def first_sentence(options: type) -> str:
    """Return the first paragraph of what a command does."""
    return " ".join((options.__doc__ or "").split("\n\n")[0].split())
