"""What a message costs between two processes, on the bus and on other transports."""
