"""Who may be whom: tokens, and certificates."""

import asyncio
import json
import shutil
import ssl
import subprocess
import threading
import time
import urllib.request
from pathlib import Path

import pytest
from isaac_helpers import Driver, says_name

from missionfsm.adapters.isaac.mission import Mission
from missionfsm.adapters.isaac.missionserver import MissionServer
from missionfsm.adapters.isaac.secrets import client_tls, server_tls, token, tokens
from missionfsm.adapters.isaac.settings import Dialling, Settings
from missionfsm.adapters.isaac.tcp import TcpMissionServer, TcpRobot, fresh_uuid
from missionfsm.isaac.runtime.missions import Close, MissionRequest, RobotOnline, RobotTakenOver, Send
from missionfsm.isaac.runtime.robot import Behavior, RobotCore
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.kernel.codec import UnreadableError


def test_isaac_server_a_name_needs_its_token() -> None:
    """Without it, with another's, or for a name that has none, the connection ends, and the robot is left alone."""
    server = Driver()
    server.core = MissionServerCore(tokens={"r": "secret", "s": "other"})
    server.add("r")
    server.connect(1)
    server.hear(1, says_name("secret", "token"))
    assert server.hear(1, says_name("r")) == [0]
    server.effects.clear()
    for connection, (said, name) in enumerate([(None, "r"), ("other", "r"), ("secret\udc00", "r"), ("", "t")], 2):
        server.connect(connection)
        if said is not None:
            server.hear(connection, says_name(said, "token"))
        server.hear(connection, says_name(name))
        assert server.effects == [Close(connection, f'it says the name "{name}" without its token')]
        server.effects.clear()
    server.connect(9)
    server.hear(9, says_name("secret", "token"))
    server.hear(9, says_name("r"))
    assert server.effects[0] == RobotTakenOver("r", 1, 9)


def test_isaac_secrets_are_read_or_said_to_be_unreadable(tmp_path: Path) -> None:
    """Files that do not hold what is wanted are one line with their name."""
    path = tmp_path / "file"
    for text in ("", "[1]", '{"r": ""}', '{"r": 5}'):
        path.write_text(text)
        with pytest.raises(UnreadableError, match="wanted a JSON object of names and tokens"):
            tokens(str(path))
    path.write_text('{"r": "x"}')
    assert tokens(str(path)) == {"r": "x"}
    path.write_text(" x \nmore")
    assert token(str(path)) == "x"
    path.write_text("\n")
    with pytest.raises(UnreadableError, match="holds no token"):
        token(str(path))
    for read in (tokens, token, client_tls):
        with pytest.raises(UnreadableError, match="missing: No such file"):
            read(str(tmp_path / "missing"))
    with pytest.raises(UnreadableError, match="file"):
        server_tls(str(path), str(path))


def certified(folder: Path) -> tuple[str, str]:
    """A certificate for this machine, and its key, as files."""
    certificate, key = str(folder / "cert"), str(folder / "key")
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "1",
         "-keyout", key, "-out", certificate, "-subj", "/CN=test", "-addext", "subjectAltName=IP:127.0.0.1"],
        check=True, capture_output=True,
    )  # fmt: skip
    return certificate, key


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_isaac_tcp_missions_go_over_tls_with_tokens(tmp_path: Path) -> None:
    """A robot that knows the certificate and its token does its mission; one that trusts nobody here never connects."""
    certificate, key = certified(tmp_path)

    async def scenario() -> None:
        seen: list[object] = []
        server = TcpMissionServer(
            Settings(port=0, tls=server_tls(certificate, key), tokens={"r": "secret"}), observer=seen.append
        )
        await server.start()
        mission = fresh_uuid()
        assert server.create(MissionRequest("r"), mission) is None
        assert server.submit(mission) is None
        notes: list[str] = []
        stranger = TcpRobot(
            RobotCore("r"),
            Dialling(port=server.port, tls=ssl.create_default_context(), first_delay=0.02),
            notes=notes.append,
        )
        core = RobotCore("r", script=(Behavior("succeed", 0.0),), token="secret")  # noqa: S106 - a test's
        robot = TcpRobot(core, Dialling(port=server.port, tls=client_tls(certificate)))
        tasks = [asyncio.create_task(one.run()) for one in (stranger, robot)]
        async with asyncio.timeout(20):
            while server.core.unfinished or not notes:  # noqa: ASYNC110 - what is waited for tells nobody
                await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await server.close()
        assert "certificate verify failed" in notes[0].lower()
        assert [type(one) for one in seen if isinstance(one, RobotOnline | Send)] == [RobotOnline, Send]

    asyncio.run(scenario())


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_isaac_missionserver_takes_what_dispatch_takes(tmp_path: Path) -> None:
    """With tokens and TLS a robot without its token gets nothing and one with it a mission; a page shows it all."""
    certificate, key = certified(tmp_path)

    async def comes(said: str | None, port: int) -> None:
        """Be a robot until the connection ends."""
        dropped = asyncio.Event()

        def note(says: str) -> None:
            if says == "disconnected":
                dropped.set()

        robot = TcpRobot(RobotCore("carter", token=said), Dialling(port=port, tls=client_tls(certificate)), notes=note)
        running = asyncio.create_task(robot.run())
        await dropped.wait()
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    with MissionServer(0, tokens={"carter": "x"}, tls=server_tls(certificate, key), http=0) as server:
        first = Mission(robot="carter", start_timeout=60)
        second = Mission(robot="elsewhere", upstream=[first])
        server.submit(first)
        server.submit(second)
        asyncio.run(comes(None, server.port))
        assert (server.get_robots(), first.status) == ([], Mission.Status.QUEUED)
        url = f"http://127.0.0.1:{server.http_port}"
        with urllib.request.urlopen(f"{url}/status.json") as page:  # noqa: S310 - http, as it says
            shown = json.load(page)
        assert shown["missions"] == [
            {"mission": 0, "robot": "carter", "status": "QUEUED", "upstream": []},
            {"mission": 1, "robot": "elsewhere", "status": "QUEUED", "upstream": [0]},
        ]
        thread = threading.Thread(target=lambda: asyncio.run(comes("x", server.port)), daemon=True)
        thread.start()
        deadline = time.monotonic() + 20
        while first.status is Mission.Status.QUEUED and time.monotonic() < deadline:
            time.sleep(0.02)
        with urllib.request.urlopen(f"{url}/metrics") as page:  # noqa: S310 - as above
            assert b"missionfsm_robots_connected 1\n" in page.read()
    thread.join()
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(f"{url}/")  # noqa: S310 - as above
