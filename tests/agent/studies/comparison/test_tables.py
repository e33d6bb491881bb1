import csv
import io
import json

from agent_proc.studies.comparison.tables import as_csv, as_json, as_text, entry_cells, kinds, versus_cells

from .parts import outcome


def test_the_tables_have_a_row_for_each_contestant_and_each_difference() -> None:
    made = outcome()
    lines = as_text(entry_cells(made)).splitlines()
    assert [line.split()[0] for line in lines] == ["trainings", "learned", "scripted", "constant"]
    assert len({len(line) for line in lines}) == 1
    assert [row[0] for row in versus_cells(made)] == ["minus scripted", "learned", "constant"]
    assert "Wilson 95 %" in kinds(made)


def test_csv_and_json_have_every_number_with_its_interval_and_kind() -> None:
    made = outcome()
    rows = list(csv.DictReader(io.StringIO(as_csv(made))))
    assert len(rows) == 3 * (7 + 1) + 2 * (6 + 1)
    iqm = next(row for row in rows if (row["contestant"], row["statistic"]) == ("learned", "IQM of loss"))
    assert (iqm["trainings"], iqm["starts"]) == ("2", "24")
    assert float(iqm["low"]) <= float(iqm["value"]) <= float(iqm["high"])
    plain = json.loads(as_json(made, {"world": "map"}))
    assert plain["world"] == "map"
    assert [entry["label"] for entry in plain["entries"]] == ["learned", "scripted", "constant"]
    assert plain["versus"][0]["differences"]["loss"]["kind"]
    assert len(plain["entries"][0]["loss_profile"]) == len(plain["loss_thresholds"])
