"""Faults of mission types and feedback."""

from __future__ import annotations

from catalogue import bug
from model import Json, Mission, State
from service import Robot


class _TypeMistaken(Robot):
    """Shows some types as another one."""

    mistaken: dict[str, str] = {}

    def shown_type(self, mission: Mission) -> Json:
        return {name: self.mistaken.get(shown, shown) for name, shown in super().shown_type(mission).items()}


@bug("servi.ServiType enum")
class _BussingShowsServing(_TypeMistaken):
    """A bussing mission is shown as a serving one."""

    mistaken = {"SERVI_TYPE_BUSSING": "SERVI_TYPE_SERVING"}


@bug("servi.ServiType enum")
class _ServingPatrolShowsServing(_TypeMistaken):
    """A serving patrol is shown as a serving mission."""

    mistaken = {"SERVI_TYPE_SERVING_PATROL": "SERVI_TYPE_SERVING"}


@bug("servi.ServiType enum")
class _BussingPatrolShowsServingPatrol(_TypeMistaken):
    """A bussing patrol is shown as a serving patrol."""

    mistaken = {"SERVI_TYPE_BUSSING_PATROL": "SERVI_TYPE_SERVING_PATROL"}


@bug("servi.ServiType enum")
class _ServiAutoShowsNavigate(_TypeMistaken):
    """A Servi's own NavigateAuto mission is shown as Navigate."""

    mistaken = {"SERVI_TYPE_NAVIGATE_AUTO": "SERVI_TYPE_NAVIGATE"}


@bug("BaseType enum")
class _BaseAutoShowsNavigate(_TypeMistaken):
    """NavigateAuto, asked for as a base mission, is shown as Navigate."""

    mistaken = {"BASE_TYPE_NAVIGATE_AUTO": "BASE_TYPE_NAVIGATE"}


@bug("carti.CartiType enum")
class _CartiAutoShowsTraverse(_TypeMistaken):
    """A Carti's own NavigateAuto mission is shown as Traverse."""

    mistaken = {"CARTI_TYPE_NAVIGATE_AUTO": "CARTI_TYPE_TRAVERSE"}


@bug("MissionType")
class _CartiTypeInServi(Robot):
    """The type of a Carti mission is put where Servi types belong."""

    def shown_type(self, mission: Mission) -> Json:
        shown = super().shown_type(mission)
        return {"serviType": shown["cartiType"]} if "cartiType" in shown else shown


@bug("MissionType")
class _BaseTypeInFamily(Robot):
    """Navigate, asked for as a base mission on a Servi, is shown as the Servi's own Navigate type."""

    def shown_type(self, mission: Mission) -> Json:
        shown = super().shown_type(mission)
        if self.world.family == "servi" and shown == {"baseType": "BASE_TYPE_NAVIGATE"}:
            return {"serviType": "SERVI_TYPE_NAVIGATE"}
        return shown


@bug("MissionType")
class _TwoTypesShown(Robot):
    """A Servi mission shows an unknown base type beside its own."""

    def shown_type(self, mission: Mission) -> Json:
        shown = super().shown_type(mission)
        return {"baseType": "BASE_TYPE_UNKNOWN", **shown} if "serviType" in shown else shown


@bug("MissionFeedback")
class _CartiFeedbackInServi(Robot):
    """The feedback of a Carti mission is put where that of Servi missions belongs."""

    def feedback_member(self, mission: Mission) -> str:
        member = super().feedback_member(mission)
        return "servi" if member == "carti" else member


@bug("MissionFeedback")
class _ServiFeedbackInBase(Robot):
    """The feedback of a Servi mission is put where that of base missions belongs."""

    def feedback_member(self, mission: Mission) -> str:
        member = super().feedback_member(mission)
        return "base" if member == "servi" and not mission.kind.charge else member


@bug("BaseFeedback › Status enum")
class _BaseFeedbackArrived(Robot):
    """A base mission that succeeded shows a status that base feedback does not have."""

    def feedback_status(self, mission: Mission) -> str:
        done = mission.kind.member == "base" and mission.state is State.SUCCEEDED
        return "STATUS_ARRIVED" if done else super().feedback_status(mission)


@bug("MissionFeedback › servi.Feedback enum")
class _QueuedShowsNavigating(Robot):
    """A mission that waits shows the feedback that the robot is on its way to its goal."""

    def feedback_status(self, mission: Mission) -> str:
        return "STATUS_NAVIGATING" if mission.state is State.DEFAULT else super().feedback_status(mission)


@bug("MissionFeedback › servi.Feedback enum")
class _FeedbackOfActive(Robot):
    """Every listed mission of a Servi shows the feedback of the active one, also those that have not been run."""

    def feedback_status(self, mission: Mission) -> str:
        if mission.kind.member == "servi" and self.current is not None:
            return self.current.feedback
        return super().feedback_status(mission)
