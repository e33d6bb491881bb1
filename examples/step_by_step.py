"""Plan, walk and push, step by step, as in a notebook."""

import legpush

# %% A world that stands at the start of the default scenario
with legpush.world("default", seed=0) as world:
    print(f"robot at {world.trunk}, box at {world.box}")

    # %% Plan a path behind the box, and walk along it
    plan = world.plan("rear")
    print(f"{plan.status}: {plan.length_m:.1f} m, {len(plan.waypoints)} waypoints")
    world.follow(plan)
    while not world.walk().world.path.done:
        pass
    print(f"walked to {world.trunk} in {world.state.tick * 0.02:.1f} s")

    # %% Push with both front legs in turn
    for leg in ("FL", "FR"):
        before = world.box
        outcome = world.push(leg=leg, depth_m=0.05)
        print(f"{leg}: peak {outcome.world.push.peak_force_n:.0f} N, box from {before} to {world.box}")
