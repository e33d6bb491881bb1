"""Python imports this file when it starts: it makes the process faulty if its cell wants that."""

from legpush.soak.in_child import main

main()
