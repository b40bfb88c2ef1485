"""What the kernel calls a system's own values. Only the system knows their types; all of them are frozen and hashable.

They are `Any` here, and nowhere else in the kernel but for `JSON` and what the library transitions takes: systems write
functions of their own classes, such as ``Callable[[Robot, Request], …]``, which do not take every hashable value.
"""

from __future__ import annotations

from typing import Any

State = Any
"""Where the system stands, without the names that stand beside it."""

World = Any
"""The parameters that ``reset`` is given, as a value."""

Request = Any
"""What a call asks for; its names are left out and stand beside it."""

Incident = Any
"""What a drive makes happen, or the environment does by itself; its names stand beside it."""

View = Any
"""What one message shows; its names stand beside it."""

Topic = Any
"""What a channel of a stream or a connection is about."""

Content = Any
"""What one message that came says; its names stand beside it."""

Shape = Any
"""What an answer says besides its code; its names stand beside it."""

Code = Any
"""What stands for a state where steps are taken fast; quick to tell apart."""

Refs = tuple[int | None, ...]
"""Of each name of a request, an incident or a message its position among those of the state; None where it has none."""
