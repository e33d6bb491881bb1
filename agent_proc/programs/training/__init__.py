"""What `legpush train` plans, shows, and does with several seeds."""
