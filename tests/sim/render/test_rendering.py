"""Which rows a film shows, how fast, and what draws them."""

import pytest

from sim_proc.render.rendering import Take, frame_rows, usual_speed


@pytest.mark.parametrize(
    ("n_rows", "speed", "fps", "expected"),
    [
        (5, 1.0, 50.0, (0, 1, 2, 3, 4)),
        (5, 2.0, 50.0, (0, 2, 4)),
        (4, 0.5, 50.0, (0, 0, 1, 1, 2, 2, 3, 3)),
        (16, 3.0, 20.0, (0, 7, 15)),
    ],
)
def test_frames_show_the_last_tick_that_was_reached(
    n_rows: int, speed: float, fps: float, expected: tuple[int, ...]
) -> None:
    assert frame_rows(n_rows, speed, fps) == expected


@pytest.mark.parametrize(("duration_s", "speed"), [(1.0, 3.0), (90.0, 3.0), (300.0, 10.0)])
def test_a_film_is_three_times_as_fast_as_the_mission_or_30_s_long(duration_s: float, speed: float) -> None:
    assert usual_speed(duration_s) == speed


@pytest.mark.parametrize(
    ("size", "drawn"), [((854, 480), (1280, 720)), ((16, 16), (24, 24)), ((3840, 2160), (5760, 3240))]
)
def test_a_frame_is_drawn_larger_with_an_even_number_of_pixels(size: tuple[int, int], drawn: tuple[int, int]) -> None:
    assert Take(rows=(0,), fps=20.0, width=size[0], height=size[1]).drawn == drawn
