"""Speed, steadiness and accuracy of the crawl along simple paths."""

from typing import Final

from experiments.rows import read_rows
from experiments.tables.parts import as_csv, as_json, made_of

N_DIGITS: Final = 4
COLUMNS: Final = (
    "length_m",
    "time_s",
    "speed_m_s",
    "cruising_speed_m_s",
    "tracking_rms_m",
    "end_error_m",
    "end_yaw_error_deg",
    "max_abs_tilt_deg",
    "min_support_margin_m",
    "com_to_centroid_m",
    "middle_to_centroid_m",
)


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("walking")
    table = [{"path": row["path"], **{name: round(row[name], N_DIGITS) for name in COLUMNS}} for row in study.rows]
    numbers = {row["path"]: {name: row[name] for name in COLUMNS} for row in table}
    return {"walking.csv": as_csv(table), "walking.json": as_json(made_of(walking=study), {"paths": numbers})}
