from statistics import fmean

import pytest

from agent_proc.studies.calibration_cell import CALIBRATION, CalibrationCell, resolve
from legpush.errors import ConfigError
from legpush.study.cells import columns_of


def test_a_series_has_the_effect_of_each_push_and_the_means_of_each_leg() -> None:
    columns = columns_of(CALIBRATION, resolve(CalibrationCell(depth_m=0.04), ()))
    assert sorted(columns["legs"]) == ["FL"] * 4 + ["FR"] * 4
    left = [value for leg, value in zip(columns["legs"], columns["each_turn_deg"], strict=True) if leg == "FL"]
    assert columns["fl_turn_deg"] == fmean(left)
    assert columns["fl_turn_deg"] < 0.0 < columns["fr_turn_deg"]
    assert 0.01 < columns["fl_forward_m"] < 0.05
    assert 0.2 < columns["max_abs_tilt_deg"] < 2.0
    assert 2.0 < columns["longest_push_s"] < 4.0
    assert columns["min_support_margin_m"] < 0.1
    assert list(columns) == [column.name for column in CALIBRATION.columns]


def test_a_face_that_cannot_be_pushed_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"Expected a face of a wedge among .*, got front"):
        resolve(CalibrationCell(face="front", changes={"box.shape": "wedge"}), ())
