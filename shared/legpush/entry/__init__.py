"""How every program begins and ends: interrupts are handled before anything else is imported.

While a program loads, nothing has begun, and SIGINT or SIGTERM ends it at once. While it works, they raise
`KeyboardInterrupt`, so that files are tidied up, unless the work handles them itself. Once its work is done, they end
it with the exit code of the work. None of this prints a traceback.
"""

import signal


def run_main(module: str, *arguments: str, profile: bool = False) -> int:
    """Run the `main` of a module as the program of this process, as `legpush.entry.program` does.

    Until that module is imported and handles signals, Ctrl-C ends the process as if Python had no handler.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from legpush.entry import program

    return program.run_main(module, *arguments, profile=profile)
