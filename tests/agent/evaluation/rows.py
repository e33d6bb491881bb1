"""Episodes for tests of what is made from them."""

from agent_proc.evaluation.episodes import Row


def row(case: str = "", seed: int = 0, position_error_m: float = 0.01, ending: str = "done") -> Row:
    """An episode."""
    return Row(
        case=case,
        seed=seed,
        ending=ending,  # type: ignore[arg-type]
        success=ending == "done",
        position_error_m=position_error_m,
        angle_error_deg=1.0,
        n_cycles=20,
        max_abs_roll_deg=0.5,
        max_abs_pitch_deg=0.7,
        simulated_s=60.0,
        min_support_margin_m=0.02,
    )
