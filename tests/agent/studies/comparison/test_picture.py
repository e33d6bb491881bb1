from pathlib import Path

from agent_proc.studies.comparison.picture import save_picture

from .parts import outcome


def test_the_picture_is_a_png(tmp_path: Path) -> None:
    save_picture(outcome(), "a title", tmp_path / "comparison.png")
    data = (tmp_path / "comparison.png").read_bytes()
    assert data.startswith(b"\x89PNG")
    assert len(data) > 20_000
