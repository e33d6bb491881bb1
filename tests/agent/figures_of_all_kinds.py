"""`python -m tests.agent.figures_of_all_kinds FOLDER`: draws one picture of each kind."""

import sys
from pathlib import Path

from agent_proc.evaluation.plot import save_plot
from agent_proc.evaluation.sweep import make_sweep
from agent_proc.reporting.map_picture import save_map_picture
from agent_proc.reporting.map_view import read_view
from agent_proc.reporting.mission_picture.picture import save_picture as save_mission_picture
from agent_proc.studies.picture import save_picture as save_table_picture
from agent_proc.studies.table import make_table
from experiments.tables.__main__ import PICTURES, Config, make
from legpush.options.maps import MapOptions
from tests.agent.evaluation.rows import row
from tests.agent.fake_world import scenario_at_station
from tests.agent.reporting.missions import push_alone
from tests.agent.studies.test_table import STUDY

KINDS = ("mission", "map", "evaluation", "study", "straight_push")


def draw(folder: Path) -> None:
    """Write a PNG of each of `KINDS`."""
    record, result = push_alone()
    save_mission_picture(record, result, folder / "mission.png")
    save_map_picture(read_view(MapOptions(file="push")), folder / "map.png")
    sweep = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,0.5"], grid=False)
    save_plot([row(case=case) for case in sweep.cases], sweep, "a policy", folder / "evaluation.png")
    by = ("box.mass_kg",)
    save_table_picture(make_table(STUDY, by, ("error_m",)), by, "a title", folder / "study.png")
    name = "straight_push"
    make(Config(names=(name,)), {name: dict}, {name: PICTURES[name]}, folder)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
