"""`[realism]` refuses what contradicts itself, and names the field."""

from typing import Any

import msgspec
import pytest
from msgspec import ValidationError

from legpush.realism.settings import Realism, interval


def read(plain: dict[str, Any]) -> Realism:
    return msgspec.convert(plain, Realism)


def test_an_item_is_a_number_or_an_interval() -> None:
    realism = read({"motor_strength": 0.8, "foot_friction": [0.6, 1.0]})
    assert (realism.motor_strength, realism.foot_friction) == (0.8, (0.6, 1.0))
    assert (interval(0.8), interval((0.6, 1.0))) == ((0.8, 0.8), (0.6, 1.0))


@pytest.mark.parametrize(
    ("plain", "told"),
    [
        ({"motor_strength": 0.0}, "motor_strength"),
        ({"motor_strength": [0.9, 1.1, 1.2]}, "motor_strength"),
        ({"motor_strength": [1.1, 0.9]}, "least, largest"),
        ({"motor_strength": float("nan")}, "motor_strength"),
        ({"command_latency_s": -0.01}, "command_latency_s"),
        ({"payload_x_m": 0.2}, "Expected payload_kg with payload_x_m"),
        ({"uphill_deg": 90.0}, "Expected slope_deg with uphill_deg"),
        ({"gusts": {"force_n": 100.0}}, "Expected duration_s with force_n"),
        ({"gusts": {"duration_s": 0.2}}, "Expected force_n with duration_s"),
        ({"gusts": {"direction_deg": 90.0}}, "Expected force_n with direction_deg"),
        ({"gusts": {"force_n": 100.0, "duration_s": 0.0}}, "gusts.duration_s"),
        (
            {"gusts": {"force_n": 1.0, "duration_s": [0.2, 0.5], "every_s": [0.4, 1.0]}},
            "every_s of at least duration_s",
        ),
        ({"floor": {"size_m": 0.3}}, "Expected height_m with size_m"),
        ({"floor": {"height_m": -0.01}}, "floor.height_m"),
        ({"box_pose": {"dropouts": 1.5}}, "box_pose.dropouts"),
        ({"box_pose": {"latency_s": -0.05}}, "box_pose.latency_s"),
        ({"localization": {"rate_hz": 0.0}}, "localization.rate_hz"),
        ({"localization": {"rate_hz": 100.0}}, "localization.rate_hz"),
        ({"localization": {"noise_m": [0.02, 0.01]}}, "least, largest"),
        ({"imu": {"gyro_noise_rad_s": -0.001}}, "imu.gyro_noise_rad_s"),
        ({"imu": {"accelerometer_bias_m_s2": [0.2, 0.1]}}, "least, largest"),
        ({"encoders": {"noise_rad": 1.0}}, "encoders.noise_rad"),
        ({"encoders": {"bias_rad": 0.1}}, "bias_rad"),
        ({"foot_forces": {"bias_n": 1000.0}}, "foot_forces.bias_n"),
        ({"sensor_latency_s": -0.002}, "sensor_latency_s"),
        ({"profile": "realistic"}, "profile"),
        ({"gyro_noise": 0.1}, "gyro_noise"),
    ],
)
def test_what_cannot_be_is_refused_by_field(plain: dict[str, Any], told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        read(plain)


def test_a_payload_may_be_swept_from_nothing() -> None:
    assert read({"payload_kg": 0.0, "payload_x_m": 0.2}).payload_kg == 0.0
