"""The readings that differ from the base where the page is silent or ambiguous."""

from __future__ import annotations

from variants import Variant as V

_NAME = "MissionSubmission › Robot Identification"
_MOCKUP = "MissionSubmission (parts of the mission client, JsonMockup)"
_CODELET = "MissionSubmission › Mission Codelet"
_CLIENT = "MissionSubmission › JsonTcpClient Codelet"

CHOICES: tuple[V, ...] = (
    V("name-waits-for-tick", "The name is first said after a period, not at once when connected.", _MOCKUP),
    V("name-four-a-second", "The name is said four times a second.", _MOCKUP),
    V("name-every-ten-seconds", "The name is said at the start and every ten seconds.", _MOCKUP),
    V("running-waits", "The first RUNNING comes after a period, not at once.", _CODELET),
    V("running-waits-after-preemption", "After a preemption the first RUNNING comes after a period.", _CODELET),
    V("status-on-the-second", "Statuses come on the full second, however long the mission has run.", _CODELET),
    V("status-ten-a-second", "RUNNING comes ten times a second.", _CODELET),
    V("status-twice-a-second", "RUNNING comes twice a second.", _CODELET),
    V("status-every-four-seconds", "RUNNING comes every four seconds.", _CODELET),
    V("status-uneven", "The period of RUNNING is 0.7 and 1.3 seconds in turn.", _CODELET),
    V("final-at-next-tick", "The final status comes with a tick, up to a tenth of a second later.", _CODELET),
    V("final-status-kept", "A final status without a connection is sent when the connection is back.", _CLIENT),
    V("all-statuses-kept", "All statuses without a connection are sent when the connection is back.", _CLIENT),
    V("disconnect-fails-mission", "A lost connection ends the mission; FAILURE is told when it is back.", _CODELET),
    V("proto-required", "A message whose header does not name its type is passed over.", _CLIENT),
    V("proto-not-looked-at", "What comes on the mission channel is a mission, whatever type it names.", _CLIENT),
    V("uuid-numbers-refused", "A mission whose UUID holds JSON numbers is passed over.", _CLIENT),
    V("missing-uuid-ignored", "A mission without a UUID is passed over.", _CODELET),
    V("missing-config-fails", "A mission without a configuration fails at once.", _CODELET),
    V("empty-config-fails", "A mission with an empty text as configuration fails at once.", _CODELET),
    V("bad-config-runs", "A configuration that is not JSON is passed over and the mission runs.", _CODELET),
    V("null-config-runs", "A configuration of null sets nothing and the mission runs.", _CODELET),
    V(
        "any-json-config-runs",
        "A configuration that is JSON but no object is passed over and the mission runs.",
        _CODELET,
    ),
    V("components-checked", "A configuration whose node holds no components fails the mission at once.", _CODELET),
    V("bad-config-running-first", "A mission that cannot be configured is RUNNING once before its FAILURE.", _CODELET),
    V("bad-config-ignored", "A message that cannot configure the application is no mission.", _CODELET),
    V("payload-first", "The payload is written before the header.", _CLIENT),
    V("spaced-json", "The JSON has blanks between its parts and at the end.", _CLIENT),
    V("unescaped-text", "Text beyond ASCII is written as it is.", _CLIENT),
    V("uuid-from-system", "Message UUIDs come from the system and differ in every run.", _CLIENT),
    V("acqtime-left-out", "The header has no time of acquisition.", _CLIENT),
    V("acqtime-zero", "The time of acquisition is 0.", _CLIENT),
    V("proto-left-out", "The header does not name the payload's type.", _CLIENT),
    V("header-has-more", "The header has one more member.", _CLIENT),
    V("statuses-in-capitals", "Statuses are written in capitals, as the page writes them.", _CODELET),
)
