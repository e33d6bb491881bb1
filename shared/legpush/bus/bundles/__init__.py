"""Messages that travel together: what an agent asks several simulators of one process, and what they answer."""
