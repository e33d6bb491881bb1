"""Pictures of results: no legend covers what is drawn, and nothing is cut off."""

import pytest

from agent_proc.figures import own_style
from experiments.tables.__main__ import PICTURES

ROUNDING_PX = 1.0


@pytest.mark.parametrize("name", [name for name in PICTURES if name != "random_rooms"])
def test_no_legend_covers_data_and_all_words_are_within_the_picture(name: str) -> None:
    with own_style({"text.parse_math": True}):
        for file, figure in PICTURES[name]().items():
            figure.draw_without_rendering()
            for axis in figure.axes:
                legend, frame = axis.get_legend(), axis.get_window_extent()
                if legend is not None:
                    assert not legend.get_window_extent().overlaps(frame), f"{file}: {axis.get_title()}"
            words = [axis.title for axis in figure.axes] + [axis.xaxis.label for axis in figure.axes]
            words += figure.texts
            for text in words:
                extent = text.get_window_extent()
                if text.get_text() and text.get_visible():
                    assert extent.x0 > -ROUNDING_PX, f"{file}: {text.get_text()}"
                    assert extent.x1 < figure.bbox.x1 + ROUNDING_PX, f"{file}: {text.get_text()}"
                    assert extent.y0 > -ROUNDING_PX, f"{file}: {text.get_text()}"
                    assert extent.y1 < figure.bbox.y1 + ROUNDING_PX, f"{file}: {text.get_text()}"
