"""Which readings of the document a mission server follows.

A field is named after its entry in the readings and holds the letter of the reading taken. Where one entry asks
several questions, each has its own field. Entries without a field leave a server no choice (AI-01, AI-02, AI-20,
AI-23, AI-27, AI-28, AI-30, AI-32, AI-34, AI-35), are the same question as another (AI-14 is AI-11), or are about the
program around the server (AI-29) or the robot (AI-33). Readings that are violations (a mission run by two robots, a
mission run twice on request) cannot be chosen.
"""

from typing import Any, Final

import attrs
from attrs import validators


def _reading(letters: str, default: str) -> Any:  # noqa: ANN401 - what attrs.field gives is not a type that can be named
    return attrs.field(default=default, validator=validators.in_(tuple(letters)), metadata={"letters": letters})


def _seconds(default: float) -> Any:  # noqa: ANN401 - as above
    return attrs.field(default=default, validator=[validators.ge(0.0), validators.lt(float("inf"))])


@attrs.frozen
class Profile:
    """One consistent choice. ValueError for a letter that an entry does not have.

    The letters:

    - ``ai_03`` a failure cancels (a) everything downstream, (b) direct downstream, and only where the robot reported
      it, (c) direct downstream alone
    - ``ai_03_when`` it does so (n) at once, (q) in the next scheduling pass, (p) in one in which the downstream heads
      the queue of a robot that is there and idle
    - ``ai_04`` a submitted mission that waits for upstreams is (a) QUEUED, (b) CREATED
    - ``ai_05`` start_timeout counts from (a) dispatch, (b) submission, (c) upstreams done, (d) the robot's connection
    - ``ai_06`` timeout counts from (a) acknowledgement, (b) dispatch, (c) submission
    - ``ai_07`` acknowledged by (a) any status, (b) RUNNING only: a final status before it is not heard, (c) the sending
    - ``ai_08`` an abort (a) changes nothing for the robot, (c) closes its connection
    - ``ai_09`` a status after the end is (a) ignored, (b) believed if final, (c) believed if final and the first after
      an abort. What was decided downstream stays decided
    - ``ai_10`` a status belongs to (a) the mission it names, or, naming none, the robot's latest on that channel,
      (b) the mission it names, (c) the mission its header names, as the header of a mission does then
    - ``ai_11`` a robot is sent (a) one mission at a time, (b) all that are ready, (c) one at a time per channel
    - ``ai_12`` a mission that waits for upstreams (a) is overtaken, (b) holds up those behind it
    - ``ai_13`` of several that are ready (a) the first submitted goes, (b) any does: here the last submitted
    - ``ai_15`` a lost connection (a) changes nothing: timeouts decide, (b) has the mission sent again, (c) fails it
    - ``ai_15_when`` it is noticed (n) at once, (p) in the next scheduling pass
    - ``ai_16`` of two connections with one name (a) the newer is the robot, (b) the older, until it drops, (d) the
      older, and the newer is closed, (n) the one that said the name later
    - ``ai_16_under_way`` what was sent on a connection that another took over from (l) is lost as if it had dropped,
      (m) goes on there without its timeouts, and the robot is free
    - ``ai_16_back`` a connection that another took over from is the robot again (q) when it says its name again,
      (r) never
    - ``ai_17`` another name on a connection is (a) ignored, (b) a new binding
    - ``ai_18_early`` a status before the name is (a) ignored, (b) kept until the name is known
    - ``ai_18_silent`` a connection without a name is (c) kept, (d) closed after ``name_timeout`` seconds
    - ``ai_19`` a mission without a robot is (a) never sent, (c) refused
    - ``ai_21`` an upstream further down in a mission file is (a) legal, (b) refused
    - ``ai_22_upstream`` an upstream that was not submitted is (a) waited for, (b) a reason to refuse, (c) submitted too
    - ``ai_22_twice`` a second submission is (d) ignored, (e) refused
    - ``ai_24`` a timeout of 0 means (a) at once, (b) none
    - ``ai_24_whole`` a timeout has elapsed (x) when so much time has passed, (w) in the first scheduling pass in which
      more whole seconds of less than a day have passed
    - ``ai_25`` 64-bit integers are taken (a) as strings and numbers, (b) as strings only
    - ``ai_26_bad`` a line that cannot be read is (e) skipped, (f) the end of its connection
    - ``ai_26_last`` a last line without an end is (c) read, (d) not
    - ``ai_31`` RUNNING that stops coming is (a) a loss after ``silence_timeout`` seconds, (b) nothing
    - ``ai_36`` a failed upstream cancels (a) at once, (b) when the other upstreams are done too
    - ``ai_37`` a name is (a) exact, (b) trimmed, (c) the same in any case; an empty one is never a name (d)
    - ``ai_38`` a message type that does not travel is (b) skipped and noted, (d) the end of its connection

    ``scheduling_period`` (AI-39): seconds between looks at the queues; 0 is at once.

    The rest are deviations of the shipped server, each a fact about it and none a reading:
    ``status_channel_follows_channel`` (the default status channel is the mission's with ``_status`` appended),
    ``header_uuid_as_numbers``, ``names_wait_for_pass`` (a name is noticed in the next scheduling pass),
    ``started_upstream_fails`` (an upstream that is STARTED when its downstream is made counts as failed).
    """

    ai_03: str = _reading("abc", "a")
    ai_03_when: str = _reading("nqp", "n")
    ai_04: str = _reading("ab", "a")
    ai_05: str = _reading("abcd", "a")
    ai_06: str = _reading("abc", "a")
    ai_07: str = _reading("abc", "a")
    ai_08: str = _reading("ac", "a")
    ai_09: str = _reading("abc", "a")
    ai_10: str = _reading("abc", "a")
    ai_11: str = _reading("abc", "a")
    ai_12: str = _reading("ab", "a")
    ai_13: str = _reading("ab", "a")
    ai_15: str = _reading("abc", "c")
    ai_15_when: str = _reading("np", "n")
    ai_16: str = _reading("abdn", "a")
    ai_16_under_way: str = _reading("lm", "l")
    ai_16_back: str = _reading("qr", "q")
    ai_17: str = _reading("ab", "a")
    ai_18_early: str = _reading("ab", "a")
    ai_18_silent: str = _reading("cd", "c")
    ai_19: str = _reading("ac", "c")
    ai_21: str = _reading("ab", "a")
    ai_22_upstream: str = _reading("abc", "a")
    ai_22_twice: str = _reading("de", "e")
    ai_24: str = _reading("ab", "a")
    ai_24_whole: str = _reading("xw", "x")
    ai_25: str = _reading("ab", "a")
    ai_26_bad: str = _reading("ef", "e")
    ai_26_last: str = _reading("cd", "c")
    ai_31: str = _reading("ab", "b")
    ai_36: str = _reading("ab", "a")
    ai_37: str = _reading("abc", "a")
    ai_38: str = _reading("bd", "b")
    scheduling_period: float = _seconds(0.0)
    name_timeout: float = _seconds(10.0)
    silence_timeout: float = _seconds(10.0)
    status_channel_follows_channel: bool = False
    header_uuid_as_numbers: bool = False
    names_wait_for_pass: bool = False
    started_upstream_fails: bool = False

    def readings(self) -> dict[str, str]:
        """The choice by entry: ``{"AI-03": "a", …}``; two letters where an entry asks two questions."""
        result: dict[str, str] = {}
        for name in _letters():
            entry = _entry(name)
            result[entry] = result.get(entry, "") + str(getattr(self, name))
        return result

    def choosing(self, entry: str, letter: str) -> "Profile":
        """This profile with another reading, as in ``choosing("AI-12", "b")``; ValueError where there is none."""
        for name, letters in _letters().items():
            if _entry(name) == entry and letter in letters:
                changes: dict[str, Any] = {name: letter}
                return attrs.evolve(self, **changes)
        known = ", ".join(f"{_entry(name)} {'|'.join(letters)}" for name, letters in _letters().items())
        msg = f"a mission server has no reading {entry} {letter}; there are {known}"
        raise ValueError(msg)


def _letters() -> dict[str, str]:
    return {field.name: field.metadata["letters"] for field in attrs.fields(Profile) if "letters" in field.metadata}


def _entry(name: str) -> str:
    return f"AI-{name[3:5]}"


DOCUMENTED: Final = Profile()
"""The default of every entry. AI-15 tolerates three; here a mission whose robot drops has failed, since with an
infinite timeout nothing else would end it."""

AS_SHIPPED: Final = Profile(
    ai_03_when="p",
    ai_10="b",
    ai_12="b",
    ai_15="c",
    ai_15_when="p",
    ai_16="n",
    ai_16_under_way="m",
    ai_16_back="r",
    ai_21="b",
    ai_22_upstream="b",
    ai_22_twice="e",
    ai_24_whole="w",
    scheduling_period=1.0,
    status_channel_follows_channel=True,
    header_uuid_as_numbers=True,
    names_wait_for_pass=True,
    started_upstream_fails=True,
)
"""What is known of the vendor's own server; where nothing is known, as DOCUMENTED.

All but submissions and lines waits for the scheduling pass, once a second: names, drops, time-outs, cancellations.
"""

PROFILES: Final = {"documented": DOCUMENTED, "as-shipped": AS_SHIPPED}
"""The profiles by the name that a command line takes."""
