"""The profiles, and what holds where a scenario states nothing."""

from msgspec.structs import asdict

from legpush.realism.profiles import IDEAL, REAL, stated
from legpush.realism.settings import FootForceSensors, ImuSensor, JointEncoders, PoseSensor, Realism


def test_the_real_profile_has_the_numbers_that_its_page_tells() -> None:
    realism = stated(Realism(profile="real"))
    assert (realism.motor_strength, realism.foot_friction) == ((0.9, 1.1), (0.6, 1.0))
    assert realism.com_x_m == realism.com_y_m == realism.com_z_m == (-0.02, 0.02)
    assert realism.box_pose == PoseSensor(noise_m=0.01, noise_deg=1.0, rate_hz=10.0, latency_s=0.05, dropouts=0.02)
    assert realism.localization == PoseSensor(noise_m=0.02, noise_deg=1.0, rate_hz=2.0, latency_s=0.0, dropouts=0.0)
    assert realism.imu == ImuSensor(
        gyro_noise_rad_s=0.0035, gyro_bias_rad_s=0.002, accelerometer_noise_m_s2=0.06, accelerometer_bias_m_s2=0.05
    )
    assert (realism.encoders, realism.sensor_latency_s) == (JointEncoders(noise_rad=0.0005), 0.02)
    assert realism.foot_forces == FootForceSensors(noise_n=4.0, bias_n=5.0)
    assert (realism.gusts, realism.floor) == (IDEAL.gusts, IDEAL.floor)


def test_what_is_stated_wins_over_the_profile_field_by_field() -> None:
    realism = stated(Realism(profile="real", motor_strength=0.7, box_pose=PoseSensor(noise_m=0.0)))
    assert realism.motor_strength == 0.7
    assert realism.box_pose == PoseSensor(noise_m=0.0, noise_deg=1.0, rate_hz=10.0, latency_s=0.05, dropouts=0.02)


def test_everything_has_a_number_but_the_friction_of_the_robot_and_the_time_between_gusts() -> None:
    for profile in (Realism(), REAL):
        whole = stated(profile)
        missing = [name for name, value in asdict(whole).items() if value is None]
        assert missing == (["foot_friction"] if profile.profile == "ideal" else [])
        seen = (whole.box_pose, whole.localization)
        nested = (whole.gusts, whole.floor, *seen, whole.imu, whole.encoders, whole.foot_forces)
        assert [name for part in nested for name, value in asdict(part).items() if value is None] == ["every_s"]
