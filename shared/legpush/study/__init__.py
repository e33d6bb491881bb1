"""Studies: files that say which cells to run, engines that run them, and folders with their rows."""
