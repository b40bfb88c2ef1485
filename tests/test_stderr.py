"""An adapter that dies shows the lines that say why, wherever the language that it is written in puts them."""

from __future__ import annotations

import pytest

from missionfsm.adapters.stderrlog import MAX_CHARACTERS, Log, telling

WRITTEN = {
    "Python": (
        [
            "Traceback (most recent call last):",
            '  File "adapter.py", line 3, in <module>',
            '    robot["x"]',
            "KeyError: 'x'",
        ],
        ("KeyError: 'x'",),
    ),
    "Node.js": (
        [
            "file:///adapter.mjs:1",
            'throw new Error("no robot")',
            "      ^",
            "Error: no robot",
            "    at file:///adapter.mjs:1:7",
            "    at ModuleJob.run (node:internal/modules/esm/module_job:325:25)",
            "Node.js v20.20.2",
        ],
        ("Error: no robot", "    at file:///adapter.mjs:1:7"),
    ),
    "Node.js, a kind of error": (
        [
            "/adapter.cjs:1",
            "robot.x",
            "      ^",
            "TypeError: robot is undefined",
            "    at f (/adapter.cjs:1:27)",
            "Node.js v20.20.2",
        ],
        ("TypeError: robot is undefined", "    at f (/adapter.cjs:1:27)"),
    ),
    "Node.js, a package that is missing": (
        [
            "node:internal/modules/run_main:123",
            "    triggerUncaughtException(",
            "    ^",
            "Error [ERR_MODULE_NOT_FOUND]: Cannot find package 'x'",
            "    at packageResolve (node:internal/modules/esm/resolve:873:9) {",
            "  code: 'ERR_MODULE_NOT_FOUND'",
            "}",
            "Node.js v20.20.2",
        ],
        (
            "Error [ERR_MODULE_NOT_FOUND]: Cannot find package 'x'",
            "    at packageResolve (node:internal/modules/esm/resolve:873:9) {",
        ),
    ),
    "Go": (
        [
            "reading the map",
            "panic: assignment to entry in nil map",
            "goroutine 1 [running]:",
            "main.main()",
            "\t/adapter.go:2 +0x2e",
        ],
        ("panic: assignment to entry in nil map", "main.main()"),
    ),
    "Rust": (
        [
            "thread 'main' (23964) panicked at src/main.rs:1:38:",
            "no robot 0",
            "note: run with `RUST_BACKTRACE=1` environment variable to display a backtrace",
        ],
        ("thread 'main' (23964) panicked at src/main.rs:1:38:", "no robot 0"),
    ),
    "Java": (
        [
            'Exception in thread "main" java.lang.RuntimeException: no robot',
            "\tat A.main(A.java:1)",
            "Caused by: java.lang.IllegalStateException: no map",
            "\tat A.load(A.java:2)",
            "\tat A.main(A.java:1)",
        ],
        ("Caused by: java.lang.IllegalStateException: no map", "\tat A.load(A.java:2)"),
    ),
    "sh": (
        [
            "sh: 1: my-adapter: not found",
        ],
        ("sh: 1: my-adapter: not found",),
    ),
    "whatever else": (
        [
            "one",
            "two",
        ],
        ("two",),
    ),
}


@pytest.mark.parametrize("language", WRITTEN)
def test_the_lines_that_tell_are_found(language: str) -> None:
    """What is shown is the error with where it came from, not the line that happens to be the last."""
    written, lines = WRITTEN[language]
    assert telling(written) == lines


def test_a_child_that_says_nothing_has_no_complaint() -> None:
    """Blank lines are nothing, and a long line is shown in part."""
    silent, loud = Log(), Log()
    silent.add(b" \n\n")
    loud.add(b"x" * 10 * MAX_CHARACTERS)
    assert (silent.complaint(), loud.complaint()) == ("", f" (stderr: {'x' * MAX_CHARACTERS})")
