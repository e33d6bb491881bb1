"""How links come about: the settings of Zenoh, and waiting for a router."""
