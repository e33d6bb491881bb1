"""The deepest overlap of rectangles, compared with a count at every place that may be the deepest."""

from itertools import pairwise, product
from time import perf_counter

from hypothesis import given, settings
from hypothesis import strategies as st

from legpush.bounds import MAX_OBSTACLES
from legpush.scene.overlap import Sides, deepest_overlap

# Few whole numbers, so that many sides touch or coincide.
ends = st.lists(st.integers(0, 6), min_size=2, max_size=2, unique=True).map(sorted)
rectangles = st.tuples(ends, ends).map(lambda sides: tuple(float(end) for side in sides for end in side))


def counted(sides: list[Sides]) -> int:
    """The same number, counted in the middle of every cell between the sides."""

    def between(ends: set[float]) -> list[float]:
        values = sorted(ends)
        return [(low + high) / 2 for low, high in pairwise(values)]

    places = product(
        between({end for x_low, x_high, _, _ in sides for end in (x_low, x_high)}),
        between({end for _, _, y_low, y_high in sides for end in (y_low, y_high)}),
    )
    return max(
        (sum(x_low < x < x_high and y_low < y < y_high for x_low, x_high, y_low, y_high in sides) for x, y in places),
        default=0,
    )


@given(st.lists(rectangles, max_size=12))
@settings(max_examples=200)
def test_the_deepest_place_is_found(sides: list[Sides]) -> None:
    assert deepest_overlap(sides) == counted(sides)


def test_rectangles_that_touch_do_not_overlap() -> None:
    assert deepest_overlap([(0, 1, 0, 1), (1, 2, 0, 1), (0, 1, 1, 2)]) == 1
    assert deepest_overlap([(0, 1, 0, 1), (0.5, 2, 0.5, 2), (0.9, 2, 0.2, 0.6)]) == 3
    assert deepest_overlap([]) == 0


def test_as_many_obstacles_as_a_room_may_have_take_a_moment() -> None:
    apart: list[Sides] = [(x, x + 0.5, y, y + 0.5) for x, y in product(range(100), range(MAX_OBSTACLES // 100))]
    over_one_another: list[Sides] = [(-i - 1.0, i + 1.0, -i - 1.0, i + 1.0) for i in range(MAX_OBSTACLES)]
    begin = perf_counter()
    assert deepest_overlap(apart) == 1
    assert deepest_overlap(over_one_another) == MAX_OBSTACLES
    assert perf_counter() - begin < 20.0
