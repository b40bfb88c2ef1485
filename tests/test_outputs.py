"""What the command line writes: whole or not at all, never over something else, and no verdict is lost with it."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import orjson
import pytest
from commandline import CommandLine

from missionfsm.adapters.outputs import same_file, write_whole
from missionfsm.adapters.stdio import Child
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.tools.check.verdict import Outcome, Verdict

FIRST = '{"missionfsm": 1, "system": "bear.mission", "world": {}}'
CLEAR = '{"call": 1, "method": "ClearMissionStatus", "params": {}}'
CLEARED = '{"return": 1, "result": {"missionIds": []}}'
REFUSED = '{"return": 1, "error": {"status": "NOT_FOUND"}}'


@pytest.fixture
def good(tmp_path: Path) -> Path:
    """A history that conforms."""
    path = tmp_path / "good.jsonl"
    path.write_text(f"{FIRST}\n{CLEAR}\n{CLEARED}\n")
    return path


@pytest.fixture
def wrong(tmp_path: Path) -> Path:
    """A history that does not."""
    path = tmp_path / "wrong.jsonl"
    path.write_text(f"{FIRST}\n{CLEAR}\n{REFUSED}\n")
    return path


def shell(script: str, *arguments: object, **variables: str) -> subprocess.CompletedProcess[str]:
    """What bash says to a script in which $m is missionfsm and $1 the first argument."""
    m = f"{sys.executable} -m missionfsm"
    command = ["bash", "-o", "pipefail", "-c", script, "bash", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "m": m, **variables})


# Files.


def test_a_link_is_followed(tmp_path: Path) -> None:
    """What a link points to is written, whether it is there already or not, and the link stays."""
    for target in (tmp_path / "there", tmp_path / "new"):
        link = tmp_path / f"link to {target.name}"
        link.symlink_to(target)
        (tmp_path / "there").write_text("old")
        write_whole(str(link), b"data")
        assert (link.is_symlink(), target.read_bytes()) == (True, b"data")


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    """A named pipe stays one, and its reader gets what is written."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(path.read_bytes()))
    reader.start()
    write_whole(str(path), b"data")
    reader.join()
    assert (read, path.is_fifo()) == ([b"data"], True)


def test_a_file_keeps_its_mode_and_its_neighbours(tmp_path: Path) -> None:
    """A private file stays private, and no other file is touched; a new one has the mode that new files have."""
    path, part, new, usual = (tmp_path / name for name in ("out", "out.part", "new", "usual"))
    path.write_text("old")
    path.chmod(0o600)
    part.write_text("mine")
    usual.write_text("")
    write_whole(str(path), b"data")
    write_whole(str(new), b"data")
    assert (path.read_bytes(), stat.S_IMODE(path.stat().st_mode)) == (b"data", 0o600)
    assert new.stat().st_mode == usual.stat().st_mode
    assert part.read_text() == "mine"
    assert sorted(tmp_path.iterdir()) == sorted((path, part, new, usual))


@pytest.mark.parametrize("name", ["folder", "file/x", "nowhere/x", "new/", 300 * "x", ""])
def test_what_cannot_be_written_leaves_nothing(tmp_path: Path, name: str) -> None:
    """A directory in the way, none to write to, and names that are none are refused, and nothing stays behind."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    with pytest.raises(UnreadableError):
        write_whole(name and f"{tmp_path}/{name}", b"data")
    assert {path.name for path in tmp_path.iterdir()} == {"folder", "file"}


@pytest.mark.parametrize("name", [".", "/", "", "{good}/x", "{good}.d/x", 300 * "x"])
@pytest.mark.parametrize("option", ["--json", "--html"])
def test_an_output_that_cannot_be_is_refused_before_the_work(
    command_line: CommandLine, good: Path, option: str, name: str
) -> None:
    """An output that cannot be written ends with status 2 and one line, before anything is judged."""
    ended = command_line("check", good, option, name.format(good=good))
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith(f"missionfsm: {option}: ")


@pytest.mark.parametrize(
    "command",
    [
        ("conform", "bear.mission", "--record"),
        ("conform", "bear.mission", "--json"),
        ("conform", "bear.mission", "--html"),
        ("explore", "bear.mission", "--json"),
        ("explore", "bear.mission", "--html"),
        ("teeth", "bear.mission", "--json"),
        ("teeth", "bear.mission", "--html"),
    ],
)
def test_every_command_refuses_it(command_line: CommandLine, tmp_path: Path, command: tuple[str, ...]) -> None:
    """Whatever may take long looks at its outputs first."""
    ended = command_line(*command, tmp_path / "no" / "out")
    says = f"missionfsm: {command[-1]}: {tmp_path}/no/out: No such file or directory\n"
    assert (ended.status, ended.out, ended.err) == (2, "", says)


def test_an_output_overwrites_no_other_file_of_the_command(
    command_line: CommandLine, good: Path, tmp_path: Path
) -> None:
    """One file for two outputs, or for an output and an input, is refused, under whatever name."""
    out, link = tmp_path / "out", tmp_path / "link"
    link.symlink_to(good)
    both = command_line("conform", "bear.mission", "--record", out, "--json", f"{tmp_path}/../{tmp_path.name}/out")
    mixed = command_line("conform", "bear.mission", "--record", "-", "--json", "-")
    read = command_line("check", good, "--json", link)
    assert (both.status, both.err) == (2, f"missionfsm: --record and --json: both go to {out}\n")
    assert (mixed.status, mixed.err) == (2, "missionfsm: --record and --json: both go to -\n")
    assert (read.status, read.err) == (2, f"missionfsm: --json: {link} is read, and would be overwritten\n")


def test_devices_and_pipes_are_nobodys_file(tmp_path: Path) -> None:
    """Two outputs may go to one pipe, as nothing is overwritten there."""
    os.mkfifo(tmp_path / "pipe")
    assert not same_file(str(tmp_path / "pipe"), str(tmp_path / "pipe"))


def test_what_cannot_be_written_takes_no_verdict_with_it(wrong: Path, tmp_path: Path) -> None:
    """Where an output fails after all, the verdict is printed and the others are written before that is said."""
    out = tmp_path / "out.json"
    ended = shell("ulimit -f 0; $m check $1 --json $2 --html >(cat)", wrong, out)
    assert (ended.returncode, ended.stderr) == (2, f"missionfsm: {out}: File too large\n")
    assert ended.stdout.startswith(f"{wrong}: violates: bear.mission")
    assert ended.stdout.rstrip().endswith("</html>")
    assert list(tmp_path.iterdir()) == [wrong]


# Stdout, stdin and stderr.


@pytest.mark.parametrize(
    ("command", "status"), [("check {good}", 0), ("check {wrong}", 1), ("check {wrong} --json -", 1), ("rules", 0)]
)
def test_whoever_reads_no_more_changes_no_status(good: Path, wrong: Path, command: str, status: int) -> None:
    """A reader that goes away is told nothing, and the verdict is as it would have been."""
    ended = shell(f"(sleep 0.2; $m {command.format(good=good, wrong=wrong)}) | true")
    assert (ended.returncode, ended.stderr) == (status, "")


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("check $1 > /dev/full", "stdout: No space left on device"),
        ("check $1 --json - > /dev/full", "stdout: No space left on device"),
        ("rules > /dev/full", "stdout: No space left on device"),
        ("rules --json >&-", "stdout is closed"),
        ("check $1 --json - >&-", "--json: stdout is closed"),
        ("adapter bear.mission < /dev/null >&-", "stdout is closed"),
        ("adapter bear.mission <&-", "stdin is closed"),
        ("check - <&-", "stdin is closed"),
        ("dispatch - <&-", "stdin is closed"),
        ("check /proc/self/mem", "/proc/self/mem: Input/output error"),
        ("check $1 --expect-violations /proc/self/mem", "/proc/self/mem: Input/output error"),
        ("diagram --missions /proc/self/mem", "/proc/self/mem: Input/output error"),
        ("dispatch /proc/self/mem", "/proc/self/mem: Input/output error"),
        ("--help > /dev/full", "No space left on device"),
        ("diagram -o ''", "--output: an empty name is no name of a folder"),
        ("check ''", "'': an empty name is no name of a file"),
    ],
)
def test_what_cannot_be_read_or_written_ends_in_one_line(good: Path, command: str, says: str) -> None:
    """Standard streams that are closed or full, and files that cannot be read, end with status 2 and one line."""
    ended = shell(f"$m {command}", good)
    assert (ended.returncode, ended.stdout, ended.stderr) == (2, "", f"missionfsm: {says}\n")


def test_stdout_has_one_place_to_write_at(good: Path, tmp_path: Path) -> None:
    """What goes to stdout by another name of it comes after what is printed, though stdout is a file."""
    out = tmp_path / "out"
    assert shell("$m check $1 --json /proc/self/fd/1 > $2", good, out).returncode == 0
    said, _, json = out.read_text().partition("{")
    assert said.startswith(f"{good}: conforms")
    assert orjson.loads("{" + json)["verdict"] == "conforms"


def test_without_stderr_a_verdict_is_a_verdict() -> None:
    """Nothing is asked of a stderr that is closed."""
    ended = shell("$m conform bear.mission --examples 1 --steps 2 --seed 1 2>&-")
    assert (ended.returncode, ended.stdout.partition(":")[0]) == (0, "conforms in part")


def test_what_an_encoding_does_not_have_is_replaced(good: Path) -> None:
    """Daggers on an ASCII terminal, and names of files that are not UTF-8, are shown as well as can be."""
    assert "  ? " in shell("$m readings bear.mission", PYTHONIOENCODING="ascii").stdout
    name = os.fsdecode(bytes(good.with_name("g")) + b"\xff")
    good.rename(name)
    json, html = good.with_name("out.json"), good.with_name("out.html")
    ended = shell("$m check $1 --json $2 --html $3", name, json, html)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert orjson.loads(json.read_bytes())["file"] == str(good.with_name("g�"))


# What comes from elsewhere.

EVIL = "r\n\x1b[31mx"
HARMLESS = r"r\n\x1b[31mx"
DELIVERY = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}


def missions(path: Path, name: str, **more: str) -> Path:
    """A robot answers two calls with one id, which is wrong."""
    calls = [{"call": number, "method": "CreateMission", "params": DELIVERY} for number in (1, 2)]
    answers = [{"return": number, "result": {"missionId": name}} for number in (1, 2)]
    lines = (orjson.dumps({**line, **more}) for pair in zip(calls, answers, strict=True) for line in pair)
    path.write_bytes(b"\n".join((FIRST.encode(), *lines)))
    return path


def test_no_terminal_obeys_a_robot(command_line: CommandLine, tmp_path: Path) -> None:
    """Names of robots and of implementations, and file names, are shown with their control characters spelled out."""
    log = missions(tmp_path / EVIL, "m", robot=EVIL)
    ended = command_line("check", log)
    assert ended.out.startswith(f"{tmp_path}/{HARMLESS} {HARMLESS}: violates: bear.mission, 4 events\n")
    missing = command_line("check", tmp_path / f"no {EVIL}")
    assert missing.err == f"missionfsm: {tmp_path}/no {HARMLESS}: No such file or directory\n"
    verdict = Verdict(Outcome.INCONCLUSIVE, "bear.mission", EVIL)
    assert str(verdict) == f"inconclusive: bear.mission {HARMLESS}, 0 events"


def test_no_terminal_obeys_what_an_adapter_complains_of(command_line: CommandLine) -> None:
    """The last line of its stderr is quoted in the one line that there is."""
    script = r"import sys; sys.exit('bo\x1b[31mom')"
    ended = command_line("conform", "bear.mission", "--", sys.executable, "-c", script)
    sent = 'it was sent initialize {"protocolVersion":1,"system":"bear.mission"}'
    says = rf"the adapter exited with status 1 before answering initialize (stderr: bo\x1b[31mom); {sent}"
    assert (ended.status, ended.err) == (3, f"missionfsm: {says}\n")
    child = Child([sys.executable, "-c", script])
    with pytest.raises(SubjectError, match=r"bo\\x1b"):
        child.exchange("initialize", {})
    child.close()


def test_people_are_shown_the_ends_of_a_long_value(command_line: CommandLine, tmp_path: Path) -> None:
    """A value of a megabyte is whole in JSON, and does not fill the terminal."""
    json, name = tmp_path / "out.json", 1_000_000 * "m"
    ended = command_line("check", missions(tmp_path / "log", name), "--json", json)
    assert (ended.status, len(ended.out) < 10_000, " … " in ended.out) == (1, True, True)
    assert orjson.loads(json.read_bytes())["violation"]["history"][2]["result"] == {"missionId": name}


# Options.


@pytest.mark.parametrize(
    "options",
    [
        ("--time", "inf"),
        ("--time", "nan"),
        ("--timeout", "nan"),
        ("--timeout", "inf"),
        ("--timeout", "86401"),
        ("--tolerance", "nan"),
        ("--tolerance", "inf"),
        ("--tolerance", "-1"),
    ],
)
def test_seconds_are_finite(command_line: CommandLine, options: tuple[str, str]) -> None:
    """Seconds that nobody can wait for are bad usage."""
    ended = command_line("conform", "bear.mission", "--examples", 1, "--steps", 1, *options)
    assert (ended.status, ended.out) == (2, "")
    assert f"Invalid value for '{options[0]}'" in ended.err


def test_teeth_need_something_to_bite(command_line: CommandLine) -> None:
    """``--only`` with what is in no name is bad input."""
    ended = command_line("teeth", "isaac.robot", "--only", "zzz")
    assert (ended.status, ended.err) == (2, "missionfsm: --only zzz: no implementation has 'zzz' in its name\n")
