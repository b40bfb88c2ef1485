"""More conversations: goals and the map, charging, skipping, clearing, faults, streams."""

from __future__ import annotations

import talks
from chat import Chat, goal, many, one, pose, workflow
from talks import ROUND, SHORT, T1, T2, T3, Talk


def navigate_auto(c: Chat) -> None:
    """NavigateAuto with some, all, and none of its goals free, at once and out of the queue."""
    for family in ("base", "servi"):
        for occupied in ([], [T1], [T1, T2], [T2], [T1, T2, T3]):
            c.reset(occupied=occupied)
            c.create(many(family, "navigateAuto", T1, T2, T3))
            c.append(many(family, "navigateAuto", T1, T2, T3))
            c.append(many("base", "navigateAuto", T1, pose(2)))
            c.drive("world", occupied=[T1] if occupied else [T2, T1])
            c.look()
            c.drive("goalReached")
            c.call("SkipGoal")
            c.look()


def auto_later(c: Chat) -> None:
    """Occupancy changes between creation, start and skip."""
    c.reset()
    c.create(many("base", "navigateAuto", T1, T2, T3))
    c.drive("world", occupied=[T1, T2])
    c.append(many("base", "navigateAuto", T1, T3))
    c.drive("world", occupied=[T3])
    c.call("SkipGoal")
    c.drive("goalReached", 2)
    c.drive("world", occupied=[T1, T2, T3])
    c.create(many("servi", "navigateAuto", T1, T3))
    c.drive("goalReached")
    c.drive("world", occupied=[T1])
    c.drive("goalReached")
    c.create(many("servi", "navigateAuto", T1, T3))
    c.drive("world", occupied=[])
    c.drive("goalReached")


def changing_map(c: Chat) -> None:
    """Destinations leave the map and come to it."""
    c.reset()
    c.create(ROUND)
    c.append(one("servi", "navigate", T1))
    c.drive("world", destinations=[T2, T3, "bar"])
    c.append(one("servi", "navigate", "bar"))
    c.append(SHORT)
    c.drive("goalReached", 3)
    c.drive("goalReached", 3)
    c.create(one("servi", "navigate", "bar"))
    c.look()


def blocked(c: Chat) -> None:
    """A robot that is unable to start."""
    calls = [
        ("CreateMission", SHORT),
        ("CreateMissionBatch", {"missions": [SHORT, ROUND]}),
        ("CreateMissionWorkflow", workflow("servi", "delivery", T1)),
        ("ChargeRobot", {}),
    ]
    for method, request in calls:
        c.reset(blocked=True)
        c.call(method, request)
        c.drive("world", blocked=False)
        c.call(method, request)
    c.reset()
    c.create(SHORT)
    c.append(ROUND)
    c.append(SHORT)
    c.drive("world", blocked=True)
    c.append(SHORT)
    c.drive("goalReached")
    c.drive("world", blocked=False)
    c.drive("goalReached")


def charging(c: Chat) -> None:
    """Charging from the call to the end, and everything around it."""
    for family in ("servi", "carti", "base"):
        c.reset(family=family)
        c.create(SHORT)
        c.call("ChargeRobot")
        c.drive("goalReached")
        c.call("ChargeRobot")
        c.look()
        c.create(SHORT)
        c.call("ChargeRobot")
        c.call("ClearMissionStatus")
        c.call("CreateMissionWorkflow", workflow(family, "traverse" if family == "carti" else "delivery", T1, T2))
        c.drive("goalReached")
        c.call("SkipGoal")
        c.update(-1, "PAUSE")
        c.update(-1, "RESUME")
        c.append(SHORT)
        c.drive("missionSucceeded")
        c.update(-1, "CANCEL")
        c.call("ChargeRobot")
        c.call("ClearMissionStatus")
        c.update(-1, "CANCEL")
        c.call("ChargeRobot")
        c.update(-1, "FINISH")
        c.call("ClearMissionStatus")
        c.call("ChargeRobot")
        c.drive("missionSucceeded")
        c.look()
        c.call("ClearMissionStatus")


def charging_refused(c: Chat) -> None:
    """What a charge needs, by itself and on a busy robot."""
    for dock in (True, False):
        for location in (True, False):
            c.reset(contactDock=dock, chargingLocation=location)
            c.call("ChargeRobot")
            c.drive("missionSucceeded")
            c.create(ROUND)
            c.call("ChargeRobot")
            c.drive("missionFailed")
            c.drive("world", contactDock=True, chargingLocation=not location)
            c.call("ChargeRobot")


def skipping(c: Chat) -> None:
    """SkipGoal at every place of a mission."""
    c.reset()
    c.call("SkipGoal")
    c.create(many("servi", "delivery", T1, T2, T3, T1))
    c.append(many("servi", "deliveryPatrol", T3, T2))
    c.call("SkipGoal")
    c.look()
    c.drive("goalReached")
    c.call("SkipGoal")
    c.call("SkipGoal")
    c.look()
    c.call("SkipGoal")
    c.call("SkipGoal")
    c.call("SkipGoal")
    c.update(1, "PAUSE")
    c.call("SkipGoal")
    c.update(1, "CANCEL")
    c.call("SkipGoal")
    c.create(SHORT)
    c.call("SkipGoal")
    c.look()


def patrols(c: Chat) -> None:
    """Patrols go on for many rounds."""
    for family, kinds in (("servi", ("deliveryPatrol", "bussingPatrol")), ("carti", ("traversePatrol",))):
        for kind in kinds:
            for names in ((T1,), (T1, T2), (T1, T2, T3)):
                c.reset(family=family)
                c.create(many(family, kind, *names))
                c.append(SHORT)
                c.drive("goalReached", 7)
                c.update(0, "PAUSE")
                c.update(0, "RESUME")
                c.drive("missionSucceeded")
                c.drive("goalReached")


def clearing(c: Chat) -> None:
    """Clearing lists of every content."""
    c.reset()
    c.create(SHORT)
    c.append(SHORT)
    c.append(SHORT)
    c.update(0, "CANCEL")
    c.drive("missionFailed")
    c.call("ClearMissionStatus")
    c.look()
    c.drive("goalReached")
    c.call("ClearMissionStatus", {"stray": True})
    c.call("ClearMissionStatus")
    c.look()
    c.call("ClearMissionStatus")
    c.create(SHORT)
    c.append(SHORT)
    c.drive("missionFailed")
    c.update(-1, "CANCEL")
    c.look()
    c.update(0, "CANCEL")
    c.append(SHORT)
    c.call("ClearMissionStatus")
    c.append(SHORT)
    c.create(SHORT)
    c.update(-1, "PAUSE")
    c.call("ClearMissionStatus")


def faults(c: Chat) -> None:
    """Calls that fail, with and without their effect."""
    for status in ("INTERNAL", "DEADLINE_EXCEEDED"):
        for applied in (False, True):
            c.reset()
            c.drive("fault", status=status, applied=applied)
            c.call("CreateMissionBatch", {"missions": [SHORT, ROUND]})
            c.look()
            c.batch(SHORT, ROUND)
            c.drive("fault", status=status, applied=applied)
            c.call("SkipGoal")
            c.append_batch(SHORT, SHORT)
            c.append_batch(SHORT, SHORT)
            c.look()


def two_streams(c: Chat) -> None:
    """Several streams show the same; one that is given up shows nothing more."""
    c.reset()
    c.create(ROUND)
    c.call("SubscribeMissionStatus")
    c.drive("goalReached")
    c.append(SHORT)
    c.look()
    c.update(0, "PAUSE")
    c.look()
    c.drive("missionFailed")
    c.drive("missionFailed")
    c.create(SHORT)
    c.drive("goalReached")
    c.call("ClearMissionStatus")
    c.create(SHORT)
    c.call("SubscribeMissionStatus", {"stray": 1})
    c.call("SubscribeMissionStatus")
    c.append(many("servi", "delivery", T1, T2, T3, T1))
    c.drive("goalReached")
    c.update(-1, "PAUSE")
    c.update(-1, "RESUME")
    c.call("SkipGoal")
    c.append(SHORT)
    c.update(-2, "PAUSE")
    c.update(-2, "CANCEL")
    c.look()


def parameters(c: Chat) -> None:
    """Deliveries with tray mappings, and fields that are written in other ways."""
    for trays in (
        [{"trayName": "top", "goal": goal(T1)}],
        [{"trayName": "top", "goal": goal(T3)}],
        [{"trayName": 4}],
        [{"trayName": "top"}],
        "top",
    ):
        c.reset()
        body = {"goals": [goal(T1), goal(T2)], "params": {"trayMappings": trays}}
        c.create({"mission": {"serviMission": {"deliveryMission": body}}})
    c.reset()
    c.create({"mission": {"servi_mission": {"bussing_mission": {"goals": [{"destination_id": T1}, pose(1.1)]}}}})
    c.append({"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": 0.1}}}}}})
    c.append({"mission": {**SHORT["mission"], "extension": {"@type": "x"}}})
    c.append({"mission": SHORT["mission"], "note": "x"})
    c.drive("goalReached", 9)


def in_haste(c: Chat) -> None:
    """Calls that do not wait until what they caused was seen."""
    c.reset()
    c.call("CreateMission", ROUND, settle=False)
    c.call("AppendMission", SHORT, settle=False)
    c.call("SkipGoal", settle=False)
    c.drive("goalReached", 2)


TALKS: dict[str, Talk] = {
    **talks.TALKS,
    **{
        talk.__name__: talk
        for talk in (
            navigate_auto,
            auto_later,
            changing_map,
            blocked,
            charging,
            charging_refused,
            skipping,
            patrols,
            clearing,
            faults,
            two_streams,
            parameters,
            in_haste,
        )
    },
}
