"""An adapter that answers wrongly: a reference with one refusal broken, on stdin and stdout."""

from __future__ import annotations

import sys

from broken import BUSY, answering

from missionfsm.adapters.stdio import serve

serve(answering("NOT_FOUND", BUSY), sys.stdin.buffer, sys.stdout.buffer)
