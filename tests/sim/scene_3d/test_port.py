"""A page gets the port that was asked for, or any free one, and an address that is taken is told."""

import socket

import pytest

from legpush.errors import ConfigError
from sim_proc.scene_3d.port import free_port

HOST = "127.0.0.1"


def test_any_free_port_can_be_listened_on() -> None:
    with socket.socket() as server:
        server.bind((HOST, free_port(HOST)))


def test_a_port_that_was_asked_for_is_kept() -> None:
    port = free_port(HOST)
    assert free_port(HOST, port) == port


def test_a_port_in_use_is_told() -> None:
    with socket.socket() as server:
        server.bind((HOST, 0))
        server.listen()
        port = server.getsockname()[1]
        with pytest.raises(ConfigError, match=f"got {HOST}:{port}"):
            free_port(HOST, port)
