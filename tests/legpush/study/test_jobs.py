from math import inf, isnan, nan

import msgspec
import pytest

from legpush.study.jobs import Answer, Job, Row, Task, decode_answer, decode_job, encode


def test_jobs_and_answers_come_back_as_they_were_with_numbers_that_are_not_finite() -> None:
    task = Task(cell="c", inputs={"seed": 1}, specification={"seed": 1, "box": [1.0, 2]})
    job = Job(kind="push", code="v", canary=None, results=("a",), tasks=(task,))
    assert decode_job(encode(job)) == job
    row = Row(cell="c", columns={"least": inf, "none": nan}, wall_s=1.0)
    got = decode_answer(encode(Answer(host="h", pid=1, numerics="native", canary="1", rows=(row,))))
    assert got.rows[0].columns["least"] == inf
    assert isnan(got.rows[0].columns["none"])


def test_other_bytes_are_refused() -> None:
    with pytest.raises(msgspec.ValidationError):
        decode_job(encode(Answer(host="h", pid=1, numerics="native", canary=None)))
