"""The table of an evaluation, as CSV and as Parquet."""

import csv
import io
from pathlib import Path

from pyarrow import parquet

from agent_proc.evaluation.sweep import make_sweep
from agent_proc.evaluation.table import as_csv, table, write_parquet
from tests.agent.evaluation.rows import row
from tests.agent.fake_world import scenario_at_station


def test_rows_have_the_swept_fields_as_columns_in_csv_and_parquet(tmp_path: Path) -> None:
    sweep = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,0.5", "box.size_m=0.4x0.5x0.4"], grid=True)
    rows = table([row(case=case, seed=seed) for case in sweep.cases for seed in (0, 1)], sweep)
    write_parquet(rows, tmp_path / "episodes.parquet")

    lines = list(csv.DictReader(io.StringIO(as_csv(rows))))
    assert [(line["box.mass_kg"], line["box.size_m"], line["seed"]) for line in lines] == [
        (mass, "0.4x0.5x0.4", seed) for mass in ("0.1", "0.5") for seed in ("0", "1")
    ]
    assert lines[0]["position_error_m"] == "0.01"
    read = parquet.read_table(tmp_path / "episodes.parquet").to_pylist()
    assert read == [dict(line) for line in rows]
