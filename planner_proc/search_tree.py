"""Thins out a search tree for display."""

from legpush.geometry import Point2


def thin(nodes: list[Point2], parents: list[int], n_most: int) -> tuple[list[Point2], list[int]]:
    """Keep at most `n_most` nodes: the last one, its ancestors, and the first ones of the others.

    `parents` holds the index of each node's parent; a root is its own parent.
    """
    if len(nodes) <= n_most:
        return nodes, parents
    branch = {len(nodes) - 1}
    node = len(nodes) - 1
    while node != parents[node]:
        node = parents[node]
        branch.add(node)
    kept = sorted({*range(max(0, n_most - len(branch))), *branch})[:n_most]
    place = {node: order for order, node in enumerate(kept)}
    return [nodes[i] for i in kept], [place[parents[i]] for i in kept]
