"""`legpush view` as people use it: pages in a real Chromium, of a recording and of a run that goes on."""

import json
import os
import re
import signal
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import version
from pathlib import Path
from threading import Thread
from urllib.parse import urlsplit

import numpy as np
import pytest
from numpy.typing import NDArray

from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.recording.mcap_file.reader import read_recording
from sim_proc.simulator import Simulator
from sim_proc.view.guard import UNKNOWN
from tests.chromium import Browser, Page, browser, chromium, until
from tests.legpush.recording.recordings import traffic, write
from tests.sim.conftest import MOTIONS
from tests.system.conftest import RecordedMission
from tests.system.missions import LEGPUSH, crc_of

if not os.environ.get("CI"):
    pytestmark = pytest.mark.skipif(chromium() is None, reason="Chromium is not installed (Debian: chromium)")


def legpush(*arguments: str, env: dict[str, str] | None = None) -> subprocess.Popen[str]:
    command, environment = [*LEGPUSH, *arguments], {**os.environ, **(env or {})}
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)


@contextmanager
def viewer(*arguments: str, env: dict[str, str] | None = None) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The printed address of a page that is served, and who serves it."""
    process = legpush("view", "--port", "0", *arguments, env=env)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S{43}", line)
        assert found is not None, line + (process.communicate()[1] if process.poll() is not None else "")
        yield found[0], process
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def chrome() -> Iterator[Browser]:
    with browser() as started:
        yield started


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A reset and two pushes."""
    path = tmp_path_factory.mktemp("recording") / "pushes.mcap"
    write(path, *traffic(MOTIONS, Simulator()))
    return path


@pytest.fixture(scope="module")
def timeline(recording: Path) -> Timeline:
    timelines = RunHistory()
    for message in read_recording([recording]).messages:
        timelines.take_message(message.topic, message.origin, message.copy)
    (only,) = timelines.episodes.values()
    return only


def scene(page: Page) -> NDArray[np.int16]:
    """The picture between the panels."""
    picture = page.screenshot()
    height, width = picture.shape[:2]
    return picture[height // 5 :, width // 4 : 3 * width // 4].astype(np.int16)


def shows(page: Page, *words: str) -> None:
    """Wait until the page says all this."""
    until(lambda: all(word in page.text for word in words), f"{words} on the page")


def pause(page: Page) -> None:
    """Stay where it is, if it has not come to the end by itself."""
    shows(page, "box error")
    page.click_if("Pause")
    until(lambda: re.search(r"^Play$", page.text, re.MULTILINE), "a button to go on with")


def time_shown(page: Page) -> float:
    return float(page.js("document.querySelector('.mantine-NumberInput-input')?.value ?? 'nan'"))


def is_drawn(page: Page) -> bool:
    """Whether the robot's yellow, the box's brown and the floor's white are there."""
    red, green, blue = np.moveaxis(scene(page), 2, 0)
    yellow = (red > 90) & (green > 70) & (blue < 70) & (red - blue > 60)
    floor = (red > 215) & (abs(red - blue) < 16)
    return bool(yellow.mean() > 0.01 and floor.mean() > 0.2)


def test_a_recording_is_drawn_played_and_moved_to_any_time_and_asks_nobody_else(
    chrome: Browser, recording: Path, timeline: Timeline
) -> None:
    with viewer(str(recording)) as (url, _), chrome.page(url) as page:
        shows(page, "Recording pushes.mcap", "Planner", "Simulator", "Agent", "step", "push", "box error")
        until(lambda: is_drawn(page), "robot and floor")
        assert page.js("document.querySelectorAll('.uplot').length") == 5

        pause(page)
        before = time_shown(page)
        page.press("ArrowLeft")
        until(lambda: time_shown(page) != before, "the tick before by a key")
        page.type_number(0.5)
        until(lambda: time_shown(page) == 0.5, "half a second")
        early = scene(page)
        page.type_number(5.0)
        until(lambda: time_shown(page) == 5.0, "five seconds")
        row = int(np.searchsorted(timeline.time_s, 5.0 - 1e-9))
        shows(page, "push FR", f"{100 * timeline.box_error()[row, 0]:.1f} cm")
        until(lambda: (np.abs(scene(page) - early).max(axis=2) > 40).mean() > 0.01, "another picture")

        page.click(">|")
        end = timeline.time_s[-1]
        until(lambda: time_shown(page) == pytest.approx(end), "the end of the push")
        page.click("<")
        until(lambda: time_shown(page) == pytest.approx(end - 0.02), "a tick before")
        page.click("Play")
        until(lambda: time_shown(page) == pytest.approx(end), "the end")

        hosts = {urlsplit(address).netloc for address in page.requests if not address.startswith(("data:", "blob:"))}
        assert hosts == {urlsplit(url).netloc}
        assert page.errors == []


def test_layers_can_be_hidden_and_the_camera_goes_where_it_is_told(chrome: Browser, recording: Path) -> None:
    with viewer(str(recording)) as (url, _), chrome.page(url) as page:
        until(lambda: is_drawn(page), "robot and floor")
        pause(page)
        page.type_number(1.0)
        until(lambda: time_shown(page) == 1.0, "one second")
        with_forces = scene(page)
        page.js(
            "[...document.querySelectorAll('label')].find(l => l.innerText.trim() === 'Support, ZMP')"
            ".closest('div').parentElement.querySelector('input[type=checkbox]').click()"
        )
        until(lambda: (np.abs(scene(page) - with_forces).max(axis=2) > 60).sum() > 50, "no support polygon")
        without = scene(page)
        page.click("Top")
        until(lambda: (np.abs(scene(page) - without).max(axis=2) > 60).mean() > 0.05, "the view from above")


def test_pages_come_and_go_and_two_show_the_same(chrome: Browser, recording: Path) -> None:
    with viewer(str(recording)) as (url, _):
        with chrome.page(url) as page:
            pause(page)
            page.type_number(1.5)
            until(lambda: time_shown(page) == 1.5, "a second and a half")
        with chrome.page(url) as first, chrome.page(url) as second:
            until(lambda: time_shown(first) == time_shown(second) == 1.5, "the same on both pages")
            until(lambda: is_drawn(first) and is_drawn(second), "robot and floor on both pages")
            second.type_number(2.5)
            until(lambda: time_shown(first) == 2.5, "what the other page did")


def test_a_mission_is_shown_while_it_lasts_and_does_not_mind_who_looks(
    chrome: Browser, tmp_path: Path, push_mission: RecordedMission
) -> None:
    own = {"TMPDIR": str(tmp_path)}
    with viewer(env=own) as (url, watching), chrome.page(url) as page:
        shows(page, "Planner", "not there")
        run = legpush("run", "push", "--no-video", "--out", str(tmp_path / "seen"), env=own)
        shows(page, "Run seen", "push F", "reward")
        until(lambda: is_drawn(page), "robot and floor")
        assert 'data-process="agent"' in str(page.js("document.body.innerHTML"))
        watching.send_signal(signal.SIGKILL)
        run.communicate(timeout=120)
    assert run.returncode == 0
    assert crc_of(tmp_path / "seen") == crc_of(push_mission.out)


OPEN_SOCKET = """
new Promise((done) => {
  const socket = new WebSocket(%s, %s);
  socket.binaryType = 'arraybuffer';
  socket.onmessage = (message) => done(message.data.byteLength);
  socket.onclose = () => done(-1);
})
"""
"""Length of the first message that a page gets from a WebSocket, -1 if it is closed before."""


@contextmanager
def other_page() -> Iterator[str]:
    """The address of a page of another program on this machine."""

    class Answer(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(HTTPStatus.OK)
            self.end_headers()
            self.wfile.write(b"<title>Another page</title>")

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Answer) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


def test_the_page_opens_with_its_token_only(chrome: Browser, recording: Path) -> None:
    with viewer(str(recording)) as (url, process):
        bare = url.partition("?")[0]
        with chrome.page(url) as page:
            shows(page, "Recording pushes.mcap")
            assert page.js("location.href") == bare
            assert page.js("document.cookie") == ""
        with chrome.page(bare) as page:
            shows(page, "Recording pushes.mcap")
        with browser() as stranger:
            for address in (bare, f"{bare}?token=wrong", url.replace("127.0.0.1", "localhost").partition("?")[0]):
                with stranger.page(address) as page:
                    assert page.text.strip() == UNKNOWN.strip()
                    assert page.js("performance.getEntriesByType('navigation')[0].responseStatus") == 403
            with stranger.page(f"{url}&fixedDpr=0.5") as page:
                shows(page, "Recording pushes.mcap")
                assert page.js("location.href") == f"{bare}?fixedDpr=0.5"
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=30)[1] == ""


def test_a_page_of_another_origin_gets_no_websocket_although_its_browser_has_the_cookie(
    chrome: Browser, recording: Path
) -> None:
    with viewer(str(recording)) as (url, _), other_page() as other:
        bare, _, token = url.partition("?")
        protocol = json.dumps(f"viser-v{version('viser')}")
        with chrome.page(url) as page:
            shows(page, "Recording pushes.mcap")
            assert page.js(OPEN_SOCKET % (json.dumps(bare.replace("http", "ws")), protocol)) > 0
        for foreign in (other, other.replace("127.0.0.1", "localhost")):
            with chrome.page(foreign) as page:
                assert page.js("document.title") == "Another page"
                for query in ("", f"?{token}"):
                    socket = json.dumps(f"{bare.replace('http', 'ws')}{query}")
                    assert page.js(OPEN_SOCKET % (socket, protocol)) == -1
                assert not page.js(f"fetch({json.dumps(bare)}, {{mode: 'no-cors'}}).then(() => true, () => false)")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nothing.mcap",), ("nothing.mcap", "can be read")),
        (("empty.mcap",), ("empty.mcap", "an empty file")),
        (("pushes.mcap", "--run", "local"), ("either the files", "--run")),
        (("--port", "70000"), ("--port", "70000")),
        (("pushes.mcap", "--host", "203.0.113.7"), ("--host", "203.0.113.7")),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    recording: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    (recording.parent / "empty.mcap").touch()
    paths = [str(recording.parent / each) if each.endswith(".mcap") else each for each in arguments]
    process = legpush("view", *paths)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert errors.startswith("error: ")
    assert errors.count("\n") == 1
    assert all(word in errors for word in words)


def test_a_port_that_is_taken_is_named(recording: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        process = legpush("view", str(recording), "--port", port)
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert port in errors
    assert "--port 0" in errors


def test_ctrl_c_ends_it_without_a_word_on_standard_error(recording: Path) -> None:
    with viewer(str(recording)) as (_, process):
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30)
    assert process.returncode == 0
    assert errors == ""
