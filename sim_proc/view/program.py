"""The program of `legpush view`: serves the page until Ctrl-C."""

import sys
import threading
import webbrowser

from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import one_line
from legpush.options.view import EVERYWHERE, ViewOptions
from legpush.output.reply import document
from legpush.service import run_command, stop_on_signals
from sim_proc.view.page import Page
from sim_proc.view.sources import LiveSource, RecordedSource


def main() -> int:
    """Serve the page until Ctrl-C."""
    return run_command("view", ViewOptions, lambda options: serve(options, stop_on_signals()))


def _live(options: ViewOptions, stop: threading.Event) -> LiveSource:
    credentials = credentials_of(options.secure, "viewer")
    return LiveSource(options.run, options.connect, credentials, routers=options.router, stop=stop)


def serve(options: ViewOptions, stop: threading.Event) -> int:
    """Serve the page until `stop` is set.

    Raises:
        LegpushError: The recording, the run or the address cannot be used.
    """
    source: RecordedSource | LiveSource
    source = RecordedSource(options.files) if options.files else _live(options, stop)
    beside = None if options.beside is None else RecordedSource([options.beside])
    with Page(source, options.host, options.port, beside) as page, source:
        also = "" if beside is None else f", beside it {one_line(beside.title)}"
        sys.stdout.write(f"{one_line(source.title)}{also}: {page.url}  (Ctrl-C ends it)\n")
        sys.stdout.write(f"    without a GPU: {page.url}&fixedDpr=0.5\n")
        if options.host == EVERYWHERE:
            sys.stdout.write("    from another machine: the same, with an address of this machine for 127.0.0.1\n")
        sys.stdout.flush()
        document({"title": source.title, "url": page.url})
        if options.open:
            webbrowser.open(page.url)
        page.run(stop)
    return 0
