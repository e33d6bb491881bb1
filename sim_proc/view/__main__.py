"""`python -m sim_proc.view`: the program behind `legpush view`."""

import sys
import webbrowser

import tyro

from legpush.errors import LegpushError
from legpush.options.view import EVERYWHERE, ViewOptions
from legpush.service import one_line, stop_on_signals
from sim_proc.view.page import Page
from sim_proc.view.sources import LiveSource, RecordedSource


def main() -> int:
    """Serve the page until Ctrl-C."""
    options = tyro.cli(ViewOptions, prog="legpush view")
    stop = stop_on_signals()
    try:
        source: RecordedSource | LiveSource
        source = RecordedSource(options.files) if options.files else LiveSource(options.run, options.connect)
        with Page(source, options.host, options.port) as page, source:
            sys.stdout.write(f"{source.title}: {page.url}  (Ctrl-C ends it)\n")
            sys.stdout.write(f"    without a GPU: {page.url}&fixedDpr=0.5\n")
            if options.host == EVERYWHERE:
                sys.stdout.write("    from another machine: the same, with an address of this machine for 127.0.0.1\n")
            sys.stdout.flush()
            if options.open:
                webbrowser.open(page.url)
            page.run(stop)
    except LegpushError as error:
        sys.stderr.write(f"error: {one_line(str(error))}\n")
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
