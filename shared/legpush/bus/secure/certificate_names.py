"""Names of certificates. Zenoh compares whole names, without patterns, so every name is listed.

A name says role, host and serial, such as `sim.robot.1`. A renewed certificate has the next serial.
"""

from typing import Final, Literal, get_args

CertificateRole = Literal["planner", "sim", "agent", "worker", "launcher", "recorder", "viewer", "router"]
"""What a certificate is for. A viewer takes part as a recorder does, but its certificate lets it say less."""
CERTIFICATE_ROLES: Final[tuple[CertificateRole, ...]] = get_args(CertificateRole)
OF_ROUTERS: Final[CertificateRole] = "router"
"""It passes on what all others say, so it is trusted with everything. Only hosts that are asked for it have it."""
PROCESS_ROLES: Final = tuple(role for role in CERTIFICATE_ROLES if role != OF_ROUTERS)
WORDS: Final[dict[CertificateRole, str]] = {
    "planner": "a planner",
    "sim": "a simulator",
    "agent": "an agent",
    "worker": "a worker of studies",
    "launcher": "a launcher",
    "recorder": "a recorder",
    "viewer": "a viewer",
    "router": "a router",
}
"""What people read."""
MAX_NAME: Final = 64
"""Most characters of a common name, by X.509."""


def certificate_name(role: CertificateRole, host: str, serial: int) -> str:
    """Return the name of a certificate."""
    return f"{role}.{host}.{serial}"
