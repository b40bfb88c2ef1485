"""The conversations that the smoke test has with every subject."""

from __future__ import annotations

from collections.abc import Callable

from chat import Chat, Json, goal, many, one, pose, workflow

Talk = Callable[[Chat], None]
T1, T2, T3 = "table-1", "table-2", "table-3"
ROUND = many("servi", "delivery", T1, T2, T3)
SHORT = one("base", "navigate", T1)
GOALS = [goal(T1), goal(T2)]


def plain_delivery(c: Chat) -> None:
    """One delivery from its creation to its end, then the next one."""
    c.reset()
    c.call("ClearMissionStatus")
    c.create(many("servi", "delivery", T3, pose(1.5, 0.5), T2, T2))
    c.create(SHORT)
    c.drive("goalReached", 4)
    c.drive("goalReached")
    c.create(one("servi", "navigate", T2))
    c.update(0, "CANCEL")
    c.drive("missionFailed")
    c.create(SHORT)
    c.update(-1, "CANCEL")
    c.create(many("servi", "bussing", T1, T3))
    c.drive("missionSucceeded")
    c.look()
    c.call("ClearMissionStatus")
    c.look()
    c.create(SHORT)
    c.look()
    c.drive("goalReached")
    c.call("ClearMissionStatus")


def pause_and_resume(c: Chat) -> None:
    """Pausing and resuming, with what is refused meanwhile."""
    c.reset()
    c.create(ROUND)
    c.update(0, "RESUME")
    c.drive("goalReached")
    c.update(0, "PAUSE")
    c.look()
    c.update(0, "PAUSE")
    c.drive("goalReached")
    c.call("SkipGoal")
    c.create(SHORT)
    c.batch(SHORT)
    c.call("CreateMissionWorkflow", workflow("servi", "delivery", T1))
    c.call("ClearMissionStatus")
    c.append(SHORT)
    c.update(1, "CANCEL")
    c.update(1, "PAUSE")
    c.call("ChargeRobot")
    c.look()
    c.update(0, "RESUME")
    c.drive("goalReached")
    c.update(0, "PAUSE")
    c.update(0, "RESUME")
    c.update(0, "PAUSE")
    c.update(0, "FINISH")
    c.update(1, "PAUSE")
    c.update(1, "RESUME")
    c.update(1, "PAUSE")
    c.drive("missionFailed")
    c.look()


def pause_and_cancel(c: Chat) -> None:
    """A paused mission can be canceled and cleared."""
    c.reset()
    c.create(many("servi", "bussingPatrol", T1, T2))
    c.drive("goalReached", 3)
    c.update(0, "PAUSE")
    c.update(0, "CANCEL")
    c.update(0, "RESUME")
    c.call("ClearMissionStatus")
    c.create(ROUND)
    c.update(-1, "PAUSE")
    c.call("ClearMissionStatus")
    c.drive("missionFailed")


def update_refusals(c: Chat) -> None:
    """Commands that are malformed or name the wrong mission, alone and together."""
    for busy in (False, True):
        c.reset()
        if busy:
            c.create(ROUND)
            c.append(SHORT)
            c.append(SHORT)
            c.update(0, "CANCEL")
        c.call("UpdateMission", {"missionCommand": {"missionId": "nobody", "command": "COMMAND_CANCEL"}})
        c.call("UpdateMission", {"missionCommand": {"missionId": "nobody", "command": "COMMAND_UNKNOWN"}})
        c.call("UpdateMission", {"missionCommand": {"missionId": "nobody", "command": 9}})
        c.call("UpdateMission", {"missionCommand": {"command": "COMMAND_PAUSE"}})
        c.call("UpdateMission", {"missionCommand": {"missionId": "", "command": "COMMAND_RESUME"}})
        c.call("UpdateMission", {"missionCommand": {}})
        c.call("UpdateMission", {})
        c.update(2, "UNKNOWN")
        c.update(2, "CANCEL")
        c.update(1, "NONSENSE")
        c.call("UpdateMission", {"missionCommand": {"missionId": c.nth(1)}})
        c.call("UpdateMission", {"mission_command": {"mission_id": c.nth(1), "command": 2}})
        c.update(0, "FINISH")
        c.update(0, "CANCEL")
        c.update(0, "PAUSE")
        c.look()


def ended_missions(c: Chat) -> None:
    """Commands to missions that have ended, on an idle robot and on a busy one."""
    for event in ("missionSucceeded", "missionFailed", "goalReached"):
        c.reset()
        c.create(SHORT)
        c.drive(event)
        for command in ("CANCEL", "FINISH", "RESUME", "PAUSE"):
            c.update(0, command)
        c.call("SkipGoal")
        c.append(SHORT)
        c.append_batch(SHORT)
        c.look()
    c.create(ROUND)
    c.update(0, "CANCEL")
    c.update(-1, "CANCEL")
    c.update(-1, "RESUME")
    c.update(-1, "CANCEL")
    c.drive("goalReached")
    c.look()


def finish_early(c: Chat) -> None:
    """The commands to finish and to cancel, midway and on the last goal."""
    c.reset()
    c.create(ROUND)
    c.append(many("servi", "deliveryPatrol", T1, T2))
    c.append(ROUND)
    c.append(many("servi", "bussing", T2, T1))
    c.drive("goalReached")
    c.update(0, "FINISH")
    c.update(1, "FINISH")
    c.drive("goalReached", 2)
    c.update(2, "CANCEL")
    c.update(3, "PAUSE")
    c.update(3, "CANCEL")
    c.look()


def refused_creations(c: Chat) -> None:
    """Whatever creates is refused on a busy robot, and nothing is left behind."""
    c.reset()
    c.create(SHORT)
    c.drive("goalReached")
    c.create(ROUND)
    c.create(SHORT)
    c.batch(SHORT, SHORT)
    c.call("CreateMissionWorkflow", workflow("servi", "bussing", T1))
    c.call("ChargeRobot")
    c.call("ClearMissionStatus")
    c.call("ClearMissionStatus", {"stray": 1})
    c.create({})
    c.batch()
    c.call("CreateMissionWorkflow", {})
    c.look()
    c.drive("goalReached", 3)
    c.look()
    c.create(SHORT)


def malformed_creations(c: Chat) -> None:
    """Malformed missions are refused and the robot stays free."""
    wrong: list[Json] = [
        {},
        {"mission": {}},
        {"mission": None},
        {"mission": {"serviMission": {}}},
        {"mission": {"serviMission": {"deliveryMission": {}}}},
        {"mission": {"serviMission": {"deliveryMission": {"goals": []}}}},
        {"mission": {"serviMission": {"bussingPatrolMission": {"goals": []}}}},
        {"mission": {"serviMission": {"deliveryMission": {"goals": "table-1"}}}},
        {"mission": {"baseMission": {"navigateMission": {"goals": GOALS}}}},
        {"mission": {"baseMission": {"navigateAutoMission": {"goal": goal(T1)}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {}}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {**goal(T1), **pose(1)}}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": 7}}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": "far"}}}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": "Infinity"}}}}}},
        {"mission": {"baseMission": SHORT["mission"]["baseMission"], "serviMission": {}}},
        {"mission": {**SHORT["mission"], **ROUND["mission"]}},
        {
            "mission": {
                "serviMission": {**ROUND["mission"]["serviMission"], "bussingMission": {"goals": [goal(T2), goal(T1)]}}
            }
        },
        {"mission": {"serviMission": {"deliveryMission": {"goals": GOALS, "speed": 3}}}},
        one("base", "navigate", "nowhere"),
        one("base", "navigate", "TABLE-1"),
        one("base", "navigate", "table"),
        one("base", "navigate", ""),
        many("servi", "delivery", T1, "nowhere"),
        many("servi", "delivery", "nowhere", T1),
        many("servi", "delivery", T1, "nowhere", T2),
        many("carti", "traverse", T1),
    ]
    for request in wrong:
        c.reset()
        c.create(request)
        c.append(request)
        c.create(ROUND)
        c.append(request)
        c.look()


def families(c: Chat) -> None:
    """Every mission type and workflow on every family."""
    for family in ("base", "servi", "carti"):
        for request in (
            many("servi", "delivery", T1, T3),
            many("servi", "bussing", T2),
            many("servi", "deliveryPatrol", T1, T2),
            many("servi", "bussingPatrol", T1),
            one("servi", "navigate", T1),
            many("servi", "navigateAuto", T2, T3),
            many("carti", "traverse", T3, T1),
            many("carti", "traversePatrol", T1, T2),
            one("carti", "navigate", pose(4.2, 1.57)),
            many("carti", "navigateAuto", T2, T3),
            one("base", "navigate", T3),
            many("base", "navigateAuto", T2, T3),
        ):
            c.reset(family=family, occupied=[T2])
            c.create(request)
            c.call("SkipGoal")
            c.drive("goalReached", 5)
            c.drive("missionSucceeded")


def workflows(c: Chat) -> None:
    """Every workflow on every family, and malformed ones."""
    kinds = ["delivery", "deliveryPatrol", "bussing", "bussingPatrol", "birthday", "hosting", "hostingPatrol"]
    for family in ("base", "servi", "carti"):
        for name, kind in [*(("servi", k) for k in kinds), ("carti", "traverse"), ("carti", "traversePatrol")]:
            c.reset(family=family)
            c.call("CreateMissionWorkflow", workflow(name, kind, T1, T2))
            c.call("CreateMissionWorkflow", workflow(name, kind, T1, T2))
            c.drive("goalReached", 3)
    one_flow = workflow("servi", "delivery", T1)["missionWorkflow"]
    two = {"serviWorkflow": {"delivery": {"goals": GOALS}, "bussing": {"goals": GOALS}}}
    malformed: list[Json] = [
        {},
        {"missionWorkflow": {}},
        {"missionWorkflow": {"serviWorkflow": {}}},
        {"missionWorkflow": two},
        {"missionWorkflow": {**one_flow, "cartiWorkflow": {"traverse": {"goals": GOALS}}}},
        {"missionWorkflow": {"serviWorkflow": {"birthday": {"goals": GOALS}}}},
        {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": []}}}},
        workflow("servi", "hosting", "nowhere"),
    ]
    for wrong in malformed:
        c.reset()
        c.call("CreateMissionWorkflow", wrong)
        c.create(SHORT)


def batches(c: Chat) -> None:
    """Batches that are fine, run to their end."""
    c.reset()
    c.batch(ROUND, one("servi", "navigate", T2), many("servi", "bussing", T3))
    c.look()
    c.batch(SHORT)
    c.drive("goalReached", 5)
    c.batch(SHORT, ROUND)
    c.append_batch(SHORT, many("servi", "bussing", T1))
    c.append_batch(one("servi", "navigate", T2), SHORT)
    c.drive("missionSucceeded", 6)
    c.look()


def refused_batches(c: Chat) -> None:
    """Batches that are refused leave nothing."""
    bad = many("servi", "delivery", T1, "nowhere")
    carti = many("carti", "traverse", T1)
    for entries in ([], [bad], [SHORT, bad], [bad, SHORT], [SHORT, {}], [SHORT, carti]):
        c.reset()
        c.batch(*entries)
        c.look()
        c.append_batch(*entries)
        c.create(ROUND)
        c.append_batch(*entries)
        c.look()
        c.drive("goalReached", 3)
        c.look()


def long_queue(c: Chat) -> None:
    """Appending one by one; the order of the queue and of the list."""
    c.reset()
    c.append(SHORT)
    c.append_batch(SHORT)
    c.create(many("servi", "delivery", T1, T2))
    for name in (T3, T2, T1):
        c.append(one("servi", "navigate", name))
    c.append(many("servi", "bussing", T1, T2, T3))
    c.append_batch(many("servi", "bussing", T3, T2, T1), many("servi", "deliveryPatrol", T2, T3))
    c.drive("goalReached", 2)
    c.look()
    c.drive("missionFailed")
    c.look()
    c.drive("goalReached", 2)
    c.drive("goalReached")
    c.call("SkipGoal")
    c.look()
    c.drive("goalReached")
    c.drive("missionSucceeded")
    c.drive("goalReached", 5)
    c.update(-1, "CANCEL")
    c.look()
    c.call("ClearMissionStatus")
    c.create(SHORT)
    c.look()
    c.update(-1, "CANCEL")


def queue_after_cancel(c: Chat) -> None:
    """What a cancel and a failure leave of the queue."""
    for ending in ("cancel", "failure", "nothing free"):
        c.reset(occupied=[T1])
        c.create(SHORT if ending != "nothing free" else many("base", "navigateAuto", T1))
        c.append(many("servi", "delivery", T2, T3))
        c.append(SHORT)
        if ending == "cancel":
            c.update(0, "CANCEL")
        else:
            c.drive("missionFailed")
        c.look()
        c.append(SHORT)
        c.drive("goalReached")
        c.create(SHORT)
        c.call("ClearMissionStatus")
        c.call("ChargeRobot")
        c.drive("missionSucceeded", 4)
        c.look()


TALKS: dict[str, Talk] = {
    talk.__name__: talk
    for talk in (
        plain_delivery,
        pause_and_resume,
        pause_and_cancel,
        update_refusals,
        ended_missions,
        finish_early,
        refused_creations,
        malformed_creations,
        families,
        workflows,
        batches,
        refused_batches,
        long_queue,
        queue_after_cancel,
    )
}
