"""`python -m benchmarks.planners {compare,peers,speed,collisions}`: measures planners.

The tables are in `benchmarks/results/`. What is in a table already is not measured again.
"""

import tyro

from benchmarks.planners import collisions, compare, peers, speed
from benchmarks.planners.tables import RESULTS

What = compare.Compare | peers.Peers | speed.Speed | collisions.Collisions


def main(what: What) -> None:
    """Carry out the chosen measurement."""
    RESULTS.mkdir(exist_ok=True)
    match what:
        case compare.Compare():
            compare.main(what)
        case peers.Peers():
            peers.main(what)
        case speed.Speed():
            speed.main(what)
        case collisions.Collisions():
            collisions.main(what)


if __name__ == "__main__":
    main(tyro.cli(What))
