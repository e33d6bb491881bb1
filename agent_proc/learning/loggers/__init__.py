"""Where the numbers of a training are logged, and what runs at its steps: built in, or of other packages."""
