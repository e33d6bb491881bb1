"""Search trees thinned out for display."""

from planner_proc.search_tree import thin

NODES = [(float(i), 0.0) for i in range(100)]
PARENTS = [0, *range(50), *[3] * 48, 10]


def test_a_tree_that_is_too_large_keeps_the_last_branch_and_its_first_nodes() -> None:
    kept, kept_parents = thin(NODES, PARENTS, 30)

    assert len(kept) == len(kept_parents) == 18 + 1
    assert kept[:18] == NODES[:18]
    node, branch = len(kept) - 1, []
    while kept_parents[node] != node:
        branch.append(kept[node])
        node = kept_parents[node]
    assert branch == [NODES[99], *(NODES[i] for i in range(10, 0, -1))]


def test_a_tree_that_is_small_enough_stays_and_a_branch_that_is_too_long_loses_its_end() -> None:
    assert thin(NODES, PARENTS, 100) == (NODES, PARENTS)
    assert thin(NODES, PARENTS, 5) == (NODES[:5], PARENTS[:5])
