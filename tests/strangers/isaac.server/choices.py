"""Readings that the page leaves open and that differ from the base."""

from __future__ import annotations

from declared import Declared

_DEPENDENCIES = "MissionServer Class › Mission Dependencies"
_NAMING = "MissionServer Class › Robot Identification"
_FIELDS = "Sample Usage › mission file table"
_CLIENT = "JsonTcpClient Codelet"
_SERVER = "JsonTcpServer Class"
_CODELET = "Mission Codelet"
_SAMPLE = "Sample Usage › sample code"
_SERVERCLASS = "MissionServer Class"

CHOICES: tuple[Declared, ...] = (
    # the order of missions
    Declared("head-blocks", "A robot's earliest queued mission holds back the later ones until it can go.", _NAMING),
    Declared("newest-first", "Of several free missions of a robot the one submitted last goes first.", _NAMING),
    Declared("ready-order", "Free missions go in the order in which they became free.", _DEPENDENCIES),
    Declared("most-downstream-first", "The free mission that most others wait for goes first.", _DEPENDENCIES),
    Declared("shortest-limit-first", "The free mission with the shortest run limit goes first.", _NAMING),
    # what follows from a failure upstream
    Declared(
        "cancel-at-turn",
        "A mission whose upstream failed is cancelled only when its turn on an idle, connected "
        "robot comes; until then it shows QUEUED.",
        _DEPENDENCIES,
    ),
    Declared(
        "cancel-when-all-ended",
        "A mission is cancelled once all its upstreams are over, if one of them failed.",
        _DEPENDENCIES,
    ),
    Declared(
        "cancel-does-not-spread",
        "A cancelled mission counts as not failed: what depends on it waits for ever.",
        _DEPENDENCIES,
    ),
    Declared(
        "cancel-after-second", "A mission whose upstream failed is cancelled one second after that.", _DEPENDENCIES
    ),
    # when the work is done
    Declared(
        "pass-every-second", "All but submission and reading happens in a pass at every whole second.", _SERVERCLASS
    ),
    Declared("sends-every-second", "Missions go out only at whole seconds.", _SERVERCLASS),
    Declared("limits-every-second", "Limits are looked at only at whole seconds.", _FIELDS),
    # limits
    Declared("limit-strictly-after", "A limit is exceeded only after its moment, not at it.", _FIELDS),
    Declared(
        "limit-whole-seconds-exceeded", "A limit is exceeded when more whole seconds than it says have passed.", _FIELDS
    ),
    Declared("limit-rounded-up", "Limits are rounded up to whole seconds.", _FIELDS),
    Declared(
        "limit-zero-waits", "A limit of zero strikes as soon as any time passes, not at the sending itself.", _FIELDS
    ),
    Declared("run-limit-from-sending", "The run limit counts from the moment the mission is sent.", _FIELDS),
    Declared(
        "held-after-abort",
        "After an abort the robot gets nothing more until it reports that mission's end or connects anew.",
        _FIELDS,
    ),
    Declared("abort-closes", "When a mission is aborted the server ends the robot's connection.", _FIELDS),
    # connections and names
    Declared("elder-keeps-name", "Of two connections with one name the one that had it first is served.", _NAMING),
    Declared("second-of-name-refused", "A connection that says a name in use is ended by the server.", _NAMING),
    Declared(
        "newer-replaces",
        "A connection that says a name in use takes its place: the older one is ended, its mission has failed.",
        _NAMING,
    ),
    Declared(
        "newer-adopts",
        "A connection that says a name in use takes over the mission under way as well: its "
        "reports are expected there.",
        _NAMING,
    ),
    Declared(
        "no-way-back", "When the newer of two connections with one name drops, the older is not served again.", _NAMING
    ),
    Declared(
        "name-again-takes-over",
        "Of two connections with one name the one that said it last, were it once more, is served.",
        _NAMING,
    ),
    Declared("name-may-change", "A connection that says another name is another robot from then on.", _NAMING),
    Declared("changed-name-closes", "A connection that says another name than before is ended by the server.", _NAMING),
    Declared("name-trimmed", "White space around a name is dropped.", _NAMING),
    Declared("empty-name-taken", "An empty text is taken as the connection's name.", _NAMING),
    Declared("unnamed-dropped", "A connection without a name for a minute is ended by the server.", _NAMING),
    Declared("greets", "On connecting, the server asks for a name by an empty text on the name channel.", _NAMING),
    Declared("echoes-name", "The server confirms a name by sending it back on the name channel.", _NAMING),
    # lost connections
    Declared(
        "drop-keeps-mission",
        "A mission outlives its connection: when the robot is back its reports count on, and the limits never stop.",
        _SERVER,
    ),
    Declared("drop-noticed-on-return", "A drop fails the mission only when the robot is back.", _SERVER),
    Declared("drop-has-grace", "A mission fails only if the robot is not back ten seconds after the drop.", _SERVER),
    Declared("drop-requeues", "A mission whose connection dropped is queued again and sent anew.", _NAMING),
    Declared(
        "drop-requeues-unacknowledged",
        "A mission whose connection dropped before the robot acknowledged it is "
        "queued again; an acknowledged one has failed.",
        _NAMING,
    ),
    # what robots send
    Declared("rubbish-closes", "The server ends a connection on which an unreadable line arrives.", _CLIENT),
    Declared("report-any-case", "Mission states are read in any case, RUNNING as well as running.", _CODELET),
    Declared("strings-only", "A report whose uuid is not made of strings is ignored.", _CLIENT),
    Declared("signed-halves", "Halves of a uuid are also read as signed numbers.", _CLIENT),
    Declared("type-id-required", "A message without the type id of its payload is ignored.", _CLIENT),
    Declared(
        "type-id-ignored", "What a message is follows from its channel and payload, whatever the type id says.", _CLIENT
    ),
    Declared("report-from-anywhere", "A report counts on whatever connection it arrives.", _SERVER),
    Declared("pause-after-failure", "After a failure the robot gets its next mission one second later.", _CODELET),
    # what the server sends
    Declared(
        "follows-channel",
        "Without a status channel of its own a mission is reported on its channel's name with _status appended.",
        _SAMPLE,
    ),
    Declared("no-acqtime", "Headers carry no acquisition time.", _CLIENT),
    Declared("message-uuid-is-mission", "A mission's message has the mission's uuid as its own.", _CLIENT),
    Declared("clock-from-zero", "Publishing times count from the start of the server.", _CLIENT),
    Declared("config-sorted", "The configuration is written with sorted keys and spaces.", _FIELDS),
    Declared("line-loose", "Lines have spaces after commas and colons, and the payload first.", _CLIENT),
    Declared("raw-letters", "Letters outside ASCII are written as they are, not escaped.", _CLIENT),
    # what is shown and accepted
    Declared("time-out-shows-failed", "An aborted mission shows FAILED.", _SAMPLE),
    Declared("cancel-shows-failed", "A cancelled mission shows FAILED.", _SAMPLE),
    Declared("drop-shows-failed", "A mission whose connection dropped shows FAILED.", _SAMPLE),
    Declared("waiting-shows-created", "A mission that waits for upstreams shows CREATED.", _SAMPLE),
    Declared("unknown-member-refused", "A mission with a member that the table lacks is refused.", _FIELDS),
    Declared("empty-channel-refused", "An empty channel name is refused.", _FIELDS),
    Declared("repeated-upstream-refused", "An upstream that is named twice is refused.", _FIELDS),
    Declared("whole-float-upstream", "An upstream may be written as a whole number with a fraction of zero.", _FIELDS),
    Declared("null-is-default", "Null in an optional field is that field's default.", _FIELDS),
)
