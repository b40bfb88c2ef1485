"""A gRPC server of the Bear API as a subject: judged with no adapter.

What the tester asks travels as binary protobuf; what streams show is collected in the background. A server that has the
control service is driven and reset by it. Any other is left as it is: its world is the one that the user says, and a
reset only ends what this tester has begun.
"""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Callable, Iterable
from typing import Any

import grpc
from attrs import evolve, frozen

from missionfsm.adapters.grpc import control
from missionfsm.adapters.grpc.begun import Begun
from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, decode, encode, methods, path, unknown
from missionfsm.adapters.grpc.failures import as_json, in_words
from missionfsm.adapters.grpc.target import Target
from missionfsm.bear.wire.methods import Method
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification, SubjectError
from missionfsm.kernel.text import brief

ENDED = ("STATE_CANCELED", "STATE_SUCCEEDED", "STATE_FAILED")
"""States of missions that need not be ended any more."""

PATIENCE = 10
"""How many times as long as the usual silence a missing message is awaited."""

MARGIN = 2
"""How many times as long as the slowest message so far a message may take."""

MAX_ROUNDS = 100
"""How many missions one reset cancels before it gives up."""


@frozen
class Use:
    """Who else uses a server, and what may be done to what is theirs.

    Attributes:
        force: whether a reset may end and clear missions that this tester did not create.
        shared: whether others use the server at the same time. Then it is never begun anew by the control service: a
            reset ends what this tester began.
        anywhere: whether conversations begin with whatever there is. Then a reset does not clear the list either.
    """

    force: bool = False
    shared: bool = False
    anywhere: bool = False

    @property
    def is_shared(self) -> bool:
        """Whether a reset leaves what others have alone."""
        return self.shared or self.anywhere


class GrpcSubject:
    """A gRPC server behind the adapter protocol.

    Args:
        system: ``bear.mission`` or ``bear.status``.
        target: where it is.
        world: its world, as JSON, if the control service cannot change it.
        use: who else uses it, and what may be done to what is theirs.
        renewed: gives the present token at every reset, since tokens expire.
        tell: given a line for people about each field that the server sends and the table does not have.

    Raises:
        SubjectError: nobody answers there.
    """

    def __init__(
        self,
        system: str,
        target: Target,
        world: JSON = None,
        *,
        use: Use = Use(),
        renewed: Callable[[], str] | None = None,
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.system = system
        self.target = target
        self.world = world or {}
        self._use = use
        self._renewed = renewed
        self._tell = tell
        self._methods = methods(system)
        try:
            self._channel = target.channel()
        except OSError as error:
            raise SubjectError(f"{target.certificate}: {error.strerror}") from None
        self._session = uuid.uuid4().hex
        self._change = threading.Condition()
        self._arrived: list[Notification] = []
        self._came: dict[int, int] = {}
        self._last = time.monotonic()
        self._streams: dict[int, Any] = {}
        self._counts = False
        self._serial = 0
        self._created: set[str] = set()
        self._patience = max(target.settle_most, target.settle)
        self._control = self._described()
        self._counts = bool(self._control) and self._is_counting()
        self.unknown: dict[str, int] = {}
        """Fields that the table does not know, by call and path, and how often they came."""

    @property
    def counts(self) -> bool:
        """Whether the server's control service says how many messages it sent, so that none is awaited in vain."""
        return self._counts

    def settle_within(self, seconds: float) -> None:
        """Take so many seconds of silence for settled from now on."""
        self.target = evolve(self.target, settle=seconds)

    def close(self) -> None:
        """Cancel every stream and close the connection."""
        self._cancel_all()
        self._channel.close()

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer one request of the adapter protocol. Raises SubjectError."""
        earlier = self._taken()
        if method == "initialize":
            return Exchange(self._introduction())
        if method == "reset":
            self._reset(params.get("world", {}))
            return Exchange({})
        if method == "settle":
            if params.get("patiently"):
                if not earlier:
                    self._settle_patiently()
            elif not self._all_came():
                self._settle()
            return Exchange({}, before=(*earlier, *self._taken()))
        if method == "cancel":
            self._cancel(params.get("stream"))
            return Exchange({}, earlier=earlier)
        if method == "drive":
            answer = Exchange(self._asked_of_control("Drive", params))
        elif method in self._methods:
            called = self._methods[method]
            answer = self._subscribe(called, params) if called.streams else self._call(called, params)
        else:
            raise SubjectError(f"{brief(method)} is no method of {self.system}")
        self._all_came()
        return evolve(answer, after=self._taken(), earlier=earlier)

    def _introduction(self) -> JSON:
        said: dict[str, JSON] = {
            "implementation": {"name": f"grpc://{self.target.address}"},
            "drives": list(self._control.get("drives", ())) if self._control else [],
            "concurrent": False,
            "requests": "binary",
        }
        if not self._counts:
            said["settles"] = "silence"
        if not self._control or self._use.is_shared:
            said |= {"worlds": "fixed", "world": self.world, "reset": "soft"}
        return said

    # Calls.

    def _call(self, method: Method, params: JSON) -> Exchange:
        ask = self._channel.unary_unary(path(method))
        self._last = time.monotonic()
        try:
            data = ask(self._encoded(method, params), timeout=self.target.timeout, metadata=self.target.sent)
        except grpc.RpcError as error:
            return Exchange(error=as_json(error))
        finally:
            self._last = time.monotonic()
        result = self._decoded(method, data)
        if method.name.startswith(("Create", "Append", "Charge")):
            self._created.update([result["missionId"]] if result.get("missionId") else result.get("missionIds", ()))
        return Exchange(result)

    def _encoded(self, method: Method, params: JSON) -> bytes:
        try:
            return encode(method.request, params)
        except NotOnTheWireError as error:
            raise SubjectError(f"{method.name}: binary protobuf cannot say {brief(params)}: {error}") from None

    def _decoded(self, method: Method, data: bytes) -> JSON:
        try:
            found = decode(method.response, data)
        except NotOnTheWireError as error:
            return {"malformed": str(error)}
        for place in unknown(method.response, data):
            name = f"{method.name}: field {place}"
            if name not in self.unknown:
                self._tell(f"{name} is not of the published definitions; it is passed over")
            self.unknown[name] = self.unknown.get(name, 0) + 1
        return found

    def _subscribe(self, method: Method, params: JSON) -> Exchange:
        """Open a stream. It has begun once initial metadata or a message came, or no refusal came for some time."""
        request = self._encoded(method, params)
        with self._change:
            self._serial += 1
            stream = self._serial
        named = ((control.SESSION_KEY, self._session), (control.STREAM_KEY, str(stream)))
        metadata = (*self.target.sent, *(named if self._control else ()))
        call = self._channel.unary_stream(path(method))(request, metadata=metadata)
        begun = Begun(call)
        # A server that counts says by initial metadata that a stream has begun.
        begun.wait(self.target.timeout if self._counts else max(self.target.begin, self.target.settle))
        if begun.refusal is not None:
            return Exchange(error=as_json(begun.refusal))
        with self._change:
            self._streams[stream] = call
            self._came[stream] = 0
            self._last = time.monotonic()
        threading.Thread(
            target=self._listen, args=(method, stream, call), name=f"missionfsm-stream-{stream}", daemon=True
        ).start()
        if not self._counts:
            self._first_message(stream)
        return Exchange({"stream": stream})

    def _first_message(self, stream: int) -> None:
        """Wait for the first message of a stream, which every page promises, and which may be late.

        If none comes, which may be right, the first message of the next stream is awaited half as long.
        """
        begun = time.monotonic()
        self._wait(lambda: self._came.get(stream, 1) > 0, self._patience)
        if time.monotonic() - begun >= self._patience:
            self._patience = max(self._patience / 2, self.target.settle)
        elif time.monotonic() - begun > self.target.settle:
            self._patience = max(self.target.settle_most, self.target.settle)

    def _listen(self, method: Method, stream: int, call: Any) -> None:  # noqa: ANN401 - a call of grpc
        try:
            for data in call:
                self._arrive(stream, "message", {"message": self._decoded(method, data)})
        except grpc.RpcError as error:
            self._arrive(stream, "closed", {"error": as_json(error)})
        else:
            self._arrive(stream, "closed", {})

    def _arrive(self, stream: int, kind: str, said: dict[str, JSON]) -> None:
        with self._change:
            if stream in self._came:
                self._arrived.append(Notification(kind, {"stream": stream, **said}))
                self._last = time.monotonic()
                if kind == "message":
                    self._came[stream] += 1
                else:  # nothing more comes, so that nothing more is waited for
                    del self._came[stream]
                self._change.notify_all()

    def _taken(self) -> tuple[Notification, ...]:
        """What has arrived, sorted by stream: messages of different streams have no order of their own."""
        with self._change:
            taken = sorted(self._arrived, key=lambda one: int(one.params["stream"]))
            self._arrived.clear()
            return tuple(taken)

    def _cancel(self, stream: JSON) -> None:
        with self._change:
            call = self._streams.pop(stream, None) if isinstance(stream, int) else None
            self._came.pop(stream, None)
            self._arrived = [one for one in self._arrived if one.params["stream"] != stream]
        if call is not None:
            call.cancel()

    def _cancel_all(self) -> None:
        for stream in tuple(self._streams):
            self._cancel(stream)

    def _wait(self, holds: Callable[[], bool], seconds: float) -> None:
        """Wait until something holds that depends on what arrives."""
        with self._change:
            self._change.wait_for(holds, seconds)

    def _all_came(self) -> bool:
        """Wait for as many messages as the control service counts. False if it does not count."""
        if not self._counts:
            return False
        if not self._came:
            return True
        try:
            sent = self._counted()
        except SubjectError:  # it is away for a moment
            return False
        self._wait(
            lambda: all(self._came.get(stream, count) >= count for stream, count in sent.items()),
            self.target.settle_most,
        )
        return True

    def _is_counting(self) -> bool:
        """Whether the control service counts what it sends; one of somebody else's may have only the rest."""
        try:
            self._counted()
        except SubjectError:
            return False
        return True

    def _counted(self) -> dict[int, int]:
        """How many messages each stream was sent, once none is on its way. Raises SubjectError."""
        said = self._asked_of_control("Settle", {"session": self._session})
        try:
            return {int(stream): int(count) for stream, count in said["streams"].items()}
        except (AttributeError, KeyError, TypeError, ValueError):
            raise SubjectError(f"the control service answered Settle with {brief(said)}") from None

    def _settle(self) -> None:
        """Wait for a silence."""
        begun = time.monotonic()
        while True:
            now = time.monotonic()
            rest = min(self._last + self.target.settle, begun + self.target.settle_most) - now
            if rest <= 0:
                return
            time.sleep(rest)

    def _settle_patiently(self) -> None:
        """Wait much longer for a missing message. If it comes, messages are awaited as long from now on."""
        caused = self._last
        with self._change:
            self._change.wait_for(lambda: self._arrived, self.target.settle * PATIENCE)
            took = self._last - caused
        if took > 0:
            self.settle_within(min(max(self.target.settle, MARGIN * took), self.target.settle_most))
            self._settle()

    # The control service, and what is done without.

    def _described(self) -> dict[str, JSON]:
        """What the control service says; empty where there is none. Raises SubjectError where nobody answers."""
        try:
            grpc.channel_ready_future(self._channel).result(self.target.timeout)
        except grpc.FutureTimeoutError:
            raise SubjectError(f"nobody answers at {self.target.address} within {self.target.timeout:g} s") from None
        try:
            found: dict[str, JSON] = self._asked_of_control("Describe", {})
        except SubjectError:
            return {}
        return found if found.get("system") == self.system else {}

    def _asked_of_control(self, name: str, value: JSON) -> JSON:
        call = self._channel.unary_unary(f"/{control.SERVICE}/{name}")
        try:
            answer = call(
                control.pack(value), timeout=self.target.timeout, metadata=self.target.sent, wait_for_ready=True
            )
            return control.unpack(answer)
        except grpc.RpcError as error:
            raise SubjectError(f"the control service answered {name} with {in_words(error)}") from None

    def _reset(self, world: JSON) -> None:
        self._cancel_all()
        if self._renewed is not None:
            self.target = evolve(self.target, token=self._renewed())
        if self._control and not self._use.is_shared:
            self._asked_of_control("Reset", {"world": world})
        elif self.system == "bear.mission":
            self._end_missions()
        self._taken()

    def _end_missions(self) -> None:
        """Cancel missions until none is left, then clear the list. Missions of others are spared as `Use` says.

        If conversations begin with whatever there is, missions of others stay, and so do own missions that wait behind
        them, which nothing can end.
        """
        for _ in range(MAX_ROUNDS):
            listed = self._listed()
            active = self._active(listed)
            if self._use.anywhere and not self._use.force and (not active or active not in self._created):
                return
            if not listed:
                return
            if not self._use.anywhere:
                self._may_touch(mission.get("missionId", "") for mission in listed)
            if not active:
                self._must("ClearMissionStatus", {})
                return
            self._must("UpdateMission", {"missionCommand": {"missionId": active, "command": "COMMAND_CANCEL"}})
            self._settle()
        raise SubjectError(f"after {MAX_ROUNDS} cancellations there are still missions that have not ended")

    def _listed(self) -> list[dict[str, JSON]]:
        """The missions that a new subscription shows first."""
        method = self._methods["SubscribeMissionStatus"]
        # A server that was away may be back in a moment, and what is asked of one that is away says nothing.
        call = self._channel.unary_stream(path(method))(
            b"", metadata=self.target.sent, timeout=self.target.timeout, wait_for_ready=True
        )
        try:
            message = self._decoded(method, next(call))
        except (grpc.RpcError, StopIteration) as error:
            raise SubjectError(f"SubscribeMissionStatus shows nothing: {in_words(error)}") from None
        finally:
            call.cancel()
        return list((message.get("missionStates") or {}).get("missions", ()))

    @staticmethod
    def _active(listed: Iterable[dict[str, JSON]]) -> str:
        """The id of the mission to cancel: the running one, or else the first waiting one; "" if all have ended."""
        open_ones = [one for one in listed if one.get("state") not in ENDED]
        running = [one for one in open_ones if one.get("state") in ("STATE_RUNNING", "STATE_PAUSED")]
        return str((running or open_ones or [{}])[0].get("missionId", ""))

    def _may_touch(self, missions: Iterable[str]) -> None:
        others = [mission for mission in missions if mission not in self._created]
        if others and not self._use.force:
            raise SubjectError(
                f"the robot has missions that this tester did not create, such as {brief(others[0])}; --force ends and "
                "clears them, --begins anywhere leaves them alone"
            )

    def _must(self, name: str, params: JSON) -> None:
        answer = self._call(self._methods[name], params)
        if answer.error is not None:
            said = f"{answer.error['status']}: {answer.error.get('message', '')}"
            raise SubjectError(f"the robot cannot be reset: {name} was answered {brief(said)}")
