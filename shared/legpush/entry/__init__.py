"""How every program begins and ends: interrupts are handled before anything heavy is imported.

While a program loads, nothing has begun, and SIGINT or SIGTERM ends it at once. While it works, they raise
`KeyboardInterrupt`, so that files are tidied up, unless the work handles them itself. Once its work is done, they end
it with the exit code of the work. None of this prints a traceback.
"""
