import csv
from pathlib import Path

import numpy as np

from agent_proc.learning.loggers.csv_log import CSV_FILE, CsvLog


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / CSV_FILE).open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_row_has_the_numbers_of_its_step_and_new_columns_come_behind(tmp_path: Path) -> None:
    log = CsvLog(tmp_path, 0)
    log.write({"b": 1, "a": np.float32(0.5), "text": "no number", "hidden": 3.0}, {"hidden": ("csv",)}, 10)
    log.write({"a": 0.1, "c": True}, {}, 20)
    log.close()
    assert (tmp_path / CSV_FILE).read_text().splitlines() == ["step,a,b,c", "10,0.5,1,", "20,0.1,,True"]


def test_a_training_that_goes_on_drops_what_comes_again(tmp_path: Path) -> None:
    before = CsvLog(tmp_path, 0)
    for step in (10, 20, 30):
        before.write({"a": step}, {}, step)
    again = CsvLog(tmp_path, 20)
    again.write({"a": 31, "b": 1}, {}, 30)
    assert [row["step"] for row in rows(tmp_path)] == ["10", "20", "30"]
    assert rows(tmp_path)[2] == {"step": "30", "a": "31", "b": "1"}
    CsvLog(tmp_path, 0)
    assert rows(tmp_path) == [], "a training that begins has no rows"
