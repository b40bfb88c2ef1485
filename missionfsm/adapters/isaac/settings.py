"""Where a mission server listens and what it follows, and whom a robot calls: what people choose."""

import ssl
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import attrs

from missionfsm.adapters.isaac.lines import WRITE_TIMEOUT
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.wire.framing import MAX_LINE

DEFAULT_PORT: Final = 9998
LOOPBACK: Final = "127.0.0.1"
"""Where is listened unless somebody asks for more: whoever can connect can say any robot's name."""


@attrs.frozen
class Settings:
    """Where a mission server listens and what it follows.

    Attributes:
        host: the address that is listened on; ``::`` is every one of this machine.
        port: where robots connect; 0 is any free one.
        name_channel: where they say their names.
        profile: the readings that are followed.
        line_limit: bytes of the longest line that is read or sent; a mission that needs more is refused.
        journal: a file in which everything that was accepted survives the server.
        resume: what becomes of a mission that was under way when the last server died, see `journal.RESUME`.
        tokens: for each robot's name the token that a connection says before it; None lets anybody be anybody.
        tls: how the server shows who it is; everything is encrypted then.
        http: the port of loopback on which a page shows where all stands; None for no page.
        write_timeout: seconds for which a peer may not read before it is dropped.
    """

    host: str = LOOPBACK
    port: int = DEFAULT_PORT
    name_channel: str = "name"
    profile: Profile = DOCUMENTED
    line_limit: int = MAX_LINE
    journal: str | Path | None = None
    resume: str = "fail"
    tokens: Mapping[str, str] | None = attrs.field(default=None, repr=False)
    tls: ssl.SSLContext | None = None
    http: int | None = None
    write_timeout: float = WRITE_TIMEOUT


@attrs.frozen
class Dialling:
    """Whom a robot calls, and how it calls again.

    Attributes:
        host, port, tls: the server, and how it is known to be the right one; unencrypted where that is None.
        first_delay, longest_delay: seconds between two attempts: twice as many after each failure, never more than the
            longest, each cut by up to a half at random so that a fleet does not come back all at once.
        connect_timeout: seconds that an attempt may take.
    """

    host: str = LOOPBACK
    port: int = DEFAULT_PORT
    tls: ssl.SSLContext | None = None
    first_delay: float = 0.1
    longest_delay: float = 5.0
    connect_timeout: float = 5.0
