"""Codes that no page of the API lists, and that any call may be answered with all the same."""

from __future__ import annotations

from missionfsm.kernel.rules import CANCELLED, RESOURCE_EXHAUSTED, UNAUTHENTICATED, UNAVAILABLE, UNIMPLEMENTED

UNLISTED = (UNAUTHENTICATED, RESOURCE_EXHAUSTED, UNIMPLEMENTED, UNAVAILABLE, CANCELLED)
"""Those of the transport and of authentication."""
