"""What programs write for people: to standard output and standard error."""
