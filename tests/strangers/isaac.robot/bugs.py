"""The faults: each contradicts a definite statement of the page."""

from __future__ import annotations

from variants import Variant as V

_NAME = "MissionSubmission › Robot Identification"
_MOCKUP = "MissionSubmission (parts of the mission client, JsonMockup)"
_RECEIVE = "MissionSubmission › Mission Codelet (a MissionProto is received)"
_START = "MissionSubmission › Mission Codelet, step 2"
_RUNNING = "MissionSubmission › Mission Codelet, step 3"
_FINAL = "MissionSubmission › Mission Codelet, step 4"
_NEXT = "MissionSubmission › Mission Codelet, step 5"
_PREEMPTED = "MissionSubmission › Mission Codelet (preemption)"
_LINES = "MissionSubmission › JsonTcpClient Codelet (newline separated objects)"
_HEADER = "MissionSubmission › JsonTcpClient Codelet (header and payload)"
_INTEGERS = "MissionSubmission › JsonTcpClient Codelet (64 bit integers)"
_CHANNELS = "MissionSubmission › Sample Usage (channel, status_channel)"

CODELET_BUGS: tuple[V, ...] = (
    V("never-running", "RUNNING is never told.", _RUNNING),
    V("running-once", "RUNNING is told once.", _RUNNING),
    V("running-ends-after-ten", "RUNNING is told ten times and no more.", _RUNNING),
    V("status-ever-slower", "The time between two RUNNING doubles each time.", _RUNNING),
    V("later-missions-without-running", "Only the first mission is told to be RUNNING.", _RUNNING),
    V("running-before-mission", "RUNNING is told before any mission.", _RUNNING),
    V("running-after-end", "RUNNING goes on after the final status.", _RUNNING),
    V("running-just-after-final", "One more RUNNING follows the final status.", _FINAL),
    V("final-missing", "The final status is missing.", _FINAL),
    V("success-untold", "SUCCESS is not told.", _FINAL),
    V("failure-untold", "FAILURE is not told when the tree reports it.", _FINAL),
    V("final-twice", "The final status is sent twice.", _FINAL),
    V("final-status-repeats", "The final status is sent again every second.", _FINAL),
    V("outcomes-swapped", "SUCCESS and FAILURE are mixed up.", _FINAL),
    V("failure-as-success", "A tree that reports failure is told as SUCCESS.", _FINAL),
    V("success-after-failure-wrong", "A success right after a failed mission is told as FAILURE.", _FINAL),
    V("success-misspelt", "SUCCESS has another word.", _FINAL),
    V("failure-told-with-next-mission", "FAILURE waits until the next mission comes.", _FINAL),
    V("failed-mission-tried-again", "A failed mission is run again by itself.", _NEXT),
    V("one-mission-only", "No second mission is taken.", _NEXT),
    V("deaf-after-failure", "After a mission that failed no other is taken.", _NEXT),
    V("uuid-of-first-mission", "The statuses of all missions name the first one.", _FINAL),
    V("preemption-ignored", "A mission that comes during another is passed over.", _PREEMPTED),
    V("preemption-waits", "A mission that comes during another waits for its end.", _PREEMPTED),
    V("same-uuid-ignored", "A mission with the UUID of the running one does not preempt it.", _PREEMPTED),
    V("preempted-untold", "The preempted mission has no final status.", _PREEMPTED),
    V("second-preemption-untold", "From the second preemption on the preempted one has no final status.", _PREEMPTED),
    V("preempted-as-success", "The preempted mission is told as SUCCESS.", _PREEMPTED),
    V("preempted-told-twice", "The FAILURE of the preempted mission is sent twice.", _PREEMPTED),
    V("preempted-under-new-uuid", "The FAILURE of a preemption names the new mission.", _PREEMPTED),
    V("preempted-goes-on", "The preempted mission is told as RUNNING for ever.", _PREEMPTED),
    V("new-told-before-old", "RUNNING of the new mission comes before FAILURE of the old one.", _PREEMPTED),
    V("new-not-started", "After a preemption the new mission does not run.", _PREEMPTED),
    V("old-uuid-after-preemption", "After a preemption the new mission is told under the old UUID.", _PREEMPTED),
    V("disconnect-silences-mission", "After a lost connection the mission is never told of again.", _RUNNING),
)

CLIENT_BUGS: tuple[V, ...] = (
    V("deaf-after-rubbish", "After a line that is no message no mission is taken.", _RECEIVE),
    V("deaf-after-reconnect", "After a reconnection no mission is taken.", _RECEIVE),
    V("statuses-stop-after-reconnect", "After a reconnection no status is sent.", _LINES),
    V("mission-channel-fixed", "Missions are taken on `mission` alone, whatever the channel is called.", _CHANNELS),
    V("mission-on-any-channel", "Missions are taken on every channel.", _CHANNELS),
    V("mission-channel-by-prefix", "Missions are taken on every channel that begins with the name.", _CHANNELS),
    V("status-on-mission-channel", "Statuses are sent on the mission channel.", _CHANNELS),
    V("status-channel-fixed", "Statuses are sent on `mission_status`, whatever the channel is called.", _CHANNELS),
    V("two-messages-in-a-line", "Messages that belong together share a line.", _LINES),
    V("no-header", "Messages have no header.", _HEADER),
    V("header-without-channel", "The header does not name the channel.", _HEADER),
    V("payload-not-wrapped", "The payload's members stand beside the header.", _HEADER),
    V("header-uuid-repeated", "All messages have the same UUID.", _HEADER),
    V("status-with-text-type", "A status calls itself a text.", _HEADER),
    V("status-without-uuid", "FAILURE does not say of which mission.", _FINAL),
    V("header-uuid-as-numbers", "The message's UUID holds JSON numbers.", _INTEGERS),
    V("uuid-as-numbers", "The mission's UUID holds JSON numbers.", _INTEGERS),
    V("pubtime-as-number", "The time of publishing is a JSON number.", _INTEGERS),
    V("proto-as-number", "The payload's type is a JSON number.", _INTEGERS),
    V("uuid-through-floats", "The mission's UUID loses its last digits.", _FINAL),
    V("uuid-signed", "The halves of the mission's UUID are written as signed numbers.", _FINAL),
    V("uuid-halves-swapped", "The halves of the mission's UUID are mixed up.", _FINAL),
    V("uuid-upper-lost", "The upper half of the mission's UUID is lost.", _FINAL),
    V("name-never", "The name is never said.", _NAME),
    V("name-once", "The name is said once for each connection.", _MOCKUP),
    V("name-silent-in-mission", "While a mission runs the name is not said.", _MOCKUP),
    V("name-silent-after-mission", "After the first status the name is not repeated.", _MOCKUP),
    V("name-lost-on-reconnect", "After a reconnection the name is not said.", _NAME),
    V("name-channel-fixed", "The name is said on `name`, whatever the channel is called.", _NAME),
    V("name-fixed", "The robot calls itself `robot`, whatever its name.", _NAME),
    V("text-field-misnamed", "The name stands in another field.", _NAME),
)

BUGS: tuple[V, ...] = CODELET_BUGS + CLIENT_BUGS
