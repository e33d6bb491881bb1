"""A headless Chromium, driven over its DevTools protocol: real pages in a real browser, drawn without a GPU."""

import base64
import json
import shutil
import subprocess
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import Any, Final
from urllib.request import urlopen

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from websockets.sync.client import connect
from websockets.sync.connection import Connection

FLAGS: Final = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # What Chromium does by itself where there is no GPU, but not where it is told how to do without.
    "--disable-gpu-compositing",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-backgrounding-occluded-windows",
    "--remote-debugging-port=0",
)
LAPTOP: Final = (1440, 900)
"""Pixels of the window."""
PATIENCE_S: Final = 60.0
COUNT_FRAMES: Final = """
window.__nFrames = 0; window.__requests = [];
{ let drawn = false;
  for (const name of ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced']) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...given) {
      if (!drawn) { drawn = true; window.__nFrames++; setTimeout(() => { drawn = false; }, 0); }
      return draw.apply(this, given);
    };
  } }
"""
"""Before anything else on a page: count the frames that WebGL draws."""


def chromium() -> str | None:
    """The browser's program; None where it is not installed."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Browser:
    """A browser and its pages."""

    def __init__(self, port: int) -> None:
        self._port = port

    @contextmanager
    def page(self, url: str) -> Iterator["Page"]:
        """Open a page in a window of its own, as those behind others are not drawn; it is closed at the end."""
        with urlopen(f"http://127.0.0.1:{self._port}/json/version", timeout=PATIENCE_S) as answer:
            whole = json.load(answer)["webSocketDebuggerUrl"]
        with connect(whole, max_size=None) as socket:
            target = Page(socket).call("Target.createTarget", url="about:blank", newWindow=True)["targetId"]
        with connect(f"ws://127.0.0.1:{self._port}/devtools/page/{target}", max_size=None) as socket:
            page = Page(socket)
            page.open(url)
            yield page
            page.call("Page.close")


@contextmanager
def browser(size: tuple[int, int] = LAPTOP, niceness: int = 0) -> Iterator[Browser]:
    """Start one with a profile of its own, and end it."""
    program = chromium()
    if program is None:
        raise FileNotFoundError("Expected Chromium, such as Debian's package chromium, got none")
    with TemporaryDirectory(prefix="browser-", ignore_cleanup_errors=True) as profile:
        command = [
            "nice",
            "-n",
            str(niceness),
            program,
            *FLAGS,
            f"--user-data-dir={profile}",
            f"--window-size={size[0]},{size[1]}",
        ]
        process = subprocess.Popen([*command, "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            port_file = Path(profile) / "DevToolsActivePort"
            until(lambda: port_file.exists() and port_file.read_text().count("\n") >= 1, "Chromium")
            yield Browser(int(port_file.read_text().splitlines()[0]))
        finally:
            process.terminate()
            process.wait(timeout=PATIENCE_S)


class Page:
    """One page; `requests` are the addresses that it asked for up to the last call."""

    def __init__(self, socket: Connection) -> None:
        self._socket = socket
        self._n_calls = 0
        self.requests: list[str] = []
        self.errors: list[str] = []
        """Exceptions that nobody caught in the page."""
        self._events: deque[dict[str, Any]] = deque()

    def open(self, url: str) -> None:
        """Go there."""
        for domain in ("Page", "Runtime", "Network"):
            self.call(f"{domain}.enable")
        # What runs in workers asks for things too, and says so to those that it is attached to.
        self.call("Target.setAutoAttach", autoAttach=True, waitForDebuggerOnStart=False, flatten=True)
        self.call("Page.addScriptToEvaluateOnNewDocument", source=COUNT_FRAMES)
        self.call("Page.navigate", url=url)
        self.until("document.readyState === 'complete' && location.href !== 'about:blank'")

    def call(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        """What the browser answers."""
        self._n_calls += 1
        number = self._n_calls
        message: dict[str, Any] = {"id": number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        self._socket.send(json.dumps(message))
        while True:
            answer: dict[str, Any] = json.loads(self._socket.recv(timeout=PATIENCE_S))
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                result: dict[str, Any] = answer["result"]
                self._take_events()
                return result
            self._events.append(answer)

    def js(self, expression: str) -> Any:
        """The value of an expression in the page, awaited if it is a promise."""
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, expression: str) -> Any:
        """Wait until an expression is true, and return it."""
        return until(lambda: self.js(expression), expression)

    def screenshot(self) -> NDArray[np.uint8]:
        """What can be seen, (height, width, 3)."""
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        return np.asarray(Image.open(BytesIO(data)).convert("RGB"))

    @property
    def text(self) -> str:
        """All that can be read."""
        return str(self.js("document.body.innerText"))

    def click(self, label: str) -> None:
        """The button with this text."""
        self.js(
            f"[...document.querySelectorAll('button')].find(b => b.innerText.trim() === {json.dumps(label)}).click()"
        )

    def click_if(self, label: str) -> None:
        """The same, if there is such a button."""
        self.js(
            f"[...document.querySelectorAll('button')].find(b => b.innerText.trim() === {json.dumps(label)})?.click()"
        )

    def press(self, key: str) -> None:
        """A key with the name that its character and its place have in common."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def type_number(self, value: float) -> None:
        """Into the first field for numbers."""
        self.js(
            "{ const field = document.querySelector('.mantine-NumberInput-input'); field.focus();"
            "  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set"
            f".call(field, {json.dumps(str(value))});"
            "  field.dispatchEvent(new Event('input', {bubbles: true})); field.blur(); }"
        )

    def _take_events(self) -> None:
        while self._events:
            event = self._events.popleft()
            parameters = event.get("params", {})
            match event.get("method"):
                case "Network.requestWillBeSent":
                    self.requests.append(parameters["request"]["url"])
                case "Network.webSocketCreated":
                    self.requests.append(parameters["url"])
                case "Runtime.exceptionThrown":
                    self.errors.append(str(parameters["exceptionDetails"])[:500])
                case "Target.attachedToTarget":
                    self.call("Network.enable", session=parameters["sessionId"])
                case _:
                    pass


def until(holds: Callable[[], Any], what: str) -> Any:
    """Wait until something holds, and return it; `TimeoutError` past `PATIENCE_S`."""
    deadline = monotonic() + PATIENCE_S
    while monotonic() < deadline:
        value = holds()
        if value:
            return value
        sleep(0.05)
    raise TimeoutError(f"Expected {what} within {PATIENCE_S:g} s")
