from legpush import in_process
from legpush.study.canary import canary


def test_the_canary_is_the_state_after_one_push_and_repeats() -> None:
    with in_process.world("push", seed=0) as world:
        outcome = world.push(0.5, 0.5, leg="FL", depth_m=0.05)
    assert canary() == f"{outcome.state_crc:08x}" == canary.__wrapped__()
