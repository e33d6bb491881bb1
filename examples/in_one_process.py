"""A whole mission in this process: no launcher, no bus, the same state in the end."""

import legpush

run = legpush.run("push", seed=1, policy="scripted")
print(f"{run.report.reason}: {run.report.detail}")
print(f"{run.report.n_push_cycles} push cycles, {run.report.sim_time_s:.1f} s simulated, state {run.state_crc}")

pushes = [record for record in run.records if isinstance(getattr(record, "motion", None), legpush.Push)]
print(f"the first of {len(pushes)} pushes: {pushes[0].motion}")
