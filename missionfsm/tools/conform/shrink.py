"""Make a violation short: what is left out or said more simply, with the live implementation asked again each time."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from attrs import define, evolve

from missionfsm.kernel.alphabet import Input
from missionfsm.kernel.codec import JSON
from missionfsm.tools.conform.actions import Action
from missionfsm.tools.conform.conversation import Conversation

Attempt = Callable[[JSON, tuple[Action, ...]], Conversation]
"""Has a conversation anew: in a world, with some actions, until it cannot be explained any more."""

MAX_ATTEMPTS = 2_000
NO_CALLS = ("drive", "cancel", "settle")
"""What has params that the protocol asks for whole."""

FEW = 24
"""Of so many actions every run is tried to be left out."""


def unexplained(conversation: Conversation) -> bool:
    """Whether a conversation cannot be explained."""
    return not conversation.right and not conversation.judge.exhausted


def shrink(
    found: Conversation,
    attempt: Attempt,
    simpler: Callable[[JSON, str], tuple[Input, ...]],
    usual: JSON,
    shows: Callable[[Conversation], bool] = unexplained,
    *,
    keep: Callable[[Conversation], None] = lambda _: None,
    enough: Callable[[], bool] = lambda: False,
) -> Conversation:
    """A conversation that shows the same, from which nothing can be left out.

    Args:
        found: one that shows it.
        attempt: has one anew.
        simpler: (world, method) to inputs that may stand in for a call of that method.
        usual: the world to have it in, if that will do.
        shows: what is to be shown; that it cannot be explained, usually.
        keep: told of every conversation that is shorter than all before.
        enough: whether no more should be tried.
    """
    return _Shrinker(found, attempt, simpler, usual, shows, keep, enough).run()


@define(eq=False)
class _Shrinker:
    best: Conversation
    attempt: Attempt
    simpler: Callable[[JSON, str], tuple[Input, ...]]
    usual: JSON
    shows: Callable[[Conversation], bool]
    keep: Callable[[Conversation], None]
    enough: Callable[[], bool]
    left: int = MAX_ATTEMPTS

    def run(self) -> Conversation:
        while self._may_try() and (self._leave_out() or self._say_simply()):
            pass
        return self.best

    def _may_try(self) -> bool:
        return self.left > 0 and not self.enough()

    @property
    def actions(self) -> tuple[Action, ...]:
        return tuple(self.best.actions)

    def _try(self, world: JSON, actions: tuple[Action, ...]) -> bool:
        """Keep this instead if it shows the same and is no longer."""
        if not self._may_try():
            return False
        self.left -= 1
        tried = self.attempt(world, actions)
        if not self.shows(tried) or len(tried.actions) > len(self.best.actions):
            return False
        self.best = tried
        self.keep(tried)
        return True

    def _leave_out(self) -> bool:
        """Leave out runs of actions, long ones first, until none can go; whether any went."""
        before = len(self.actions)
        size = max(1, before // 2)
        while size > 0 and self._may_try():
            few = len(self.actions) <= FEW
            at = 0
            while at < len(self.actions):
                actions = self.actions
                if not self._try(self.best.world, actions[:at] + actions[at + size :]):
                    at += 1 if few else size
            # Of few actions runs of every length are tried: a round of something may go where no part of it can.
            size = min(size - 1, len(self.actions) - 1) if few else size // 2
        return len(self.actions) < before

    def _say_simply(self) -> bool:
        """Put simpler things in place of what was done; whether that changed anything."""
        changed = self.best.world != self.usual and self._try(self.usual, self.actions)
        for at in range(len(self.actions)):
            for action in self._simpler_actions(self.actions[at]):
                actions = self.actions
                if self._try(self.best.world, (*actions[:at], action, *actions[at + 1 :])):
                    changed = True
                    break
            if at + 1 >= len(self.actions):
                break
        return changed

    def _simpler_actions(self, action: Action) -> Iterator[Action]:
        said = len(repr(action.params))
        for prompt in self.simpler(self.best.world, action.method):
            if len(repr(prompt.params)) < said:
                yield evolve(action, params=prompt.params)
        if action.method not in NO_CALLS:
            yield from (evolve(action, params=fewer) for fewer in _without_a_member(action.params))
        yield from (evolve(action, params=shorter) for shorter in _shorter(action.params))


def _without_a_member(params: JSON) -> Iterator[JSON]:
    """The same params with one member of the whole left out: who has a question to ask can do without some."""
    if isinstance(params, dict) and len(params) > 1:
        yield from ({name: one for name, one in params.items() if name != left_out} for left_out in params)


def _shorter(params: JSON) -> Iterator[JSON]:
    """The same params with one entry of one list left out; lists keep at least one."""
    if isinstance(params, dict):
        for key, value in params.items():
            yield from ({**params, key: shorter} for shorter in _shorter(value))
    elif isinstance(params, list):
        if len(params) > 1:
            yield from (params[:at] + params[at + 1 :] for at in range(len(params)))
        for at, value in enumerate(params):
            yield from ([*params[:at], shorter, *params[at + 1 :]] for shorter in _shorter(value))
