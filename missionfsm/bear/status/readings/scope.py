"""What a question ranges over, part by part: the calls."""

from __future__ import annotations

from missionfsm.bear.status.state import GET, Endpoint

BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE, ROBOT = SUBSCRIPTIONS = tuple(one.value for one in Endpoint)
CALLS = (GET, *SUBSCRIPTIONS)
STATES = (GET, ROBOT)
"""The calls that show a whole state."""
