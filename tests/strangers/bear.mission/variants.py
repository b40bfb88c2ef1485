"""All variants: importing this module declares them. MODULES names where, in the order for reading."""

from __future__ import annotations

import bugs_batch
import bugs_clear
import bugs_create
import bugs_order
import bugs_status
import bugs_stream
import bugs_types
import bugs_update
import bugs_workflow
import choices_checks
import choices_messages
import choices_queue
import choices_shape
from catalogue import BUGS, CHOICES

MODULES = (
    choices_checks,
    choices_queue,
    choices_messages,
    choices_shape,
    bugs_create,
    bugs_batch,
    bugs_order,
    bugs_workflow,
    bugs_clear,
    bugs_update,
    bugs_status,
    bugs_types,
    bugs_stream,
)

__all__ = ["BUGS", "CHOICES", "MODULES"]
