"""Warm spares: processes that have loaded everything and wait to take the place of one that has ended."""

from collections.abc import Iterable, Sequence

from app.supervisor.child import Child
from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.clock import NS_PER_S
from vision_core.rtdb.process_state import SETTLED, ProcessState

SILENCE_S = 2.0
"""A spare whose heartbeat is older is checked as any process is."""
FRESH_S = 0.5
"""A spare whose heartbeat is older takes no place: it writes ten a second."""


def spare_plans(plan: ServicePlan) -> tuple[ChildPlan, ...]:
    """The plan of each warm spare."""
    return tuple(
        ChildPlan(
            name=name,
            module=plan.spare_module,
            wakes=(),
            writes=(),
            sockets=(),
            after="",
            once=False,
            heartbeat_s=SILENCE_S,
            longest_run_s=SILENCE_S,
            spared=False,
            purpose="stands by",
        )
        for name in plan.spares
    )


class Spares:
    """The spares of a service. When none is ready, a child is started from nothing."""

    def __init__(self, spares: Sequence[Child]) -> None:
        self.all = tuple(spares)

    def take_place(self, child: Child, now: int) -> Child | None:
        """Let a spare become a child. Returns this spare, or None when none is ready."""
        if not child.plan.spared:
            return None
        for spare in self.all:
            fresh = now - spare.last_heartbeat < FRESH_S * NS_PER_S
            if spare.state == ProcessState.RUNNING and fresh and not spare.has_ended() and spare.hand_over(child, now):
                return spare
        return None

    def refill(self, children: Iterable[Child], now: int) -> None:
        """Start a missing spare when no other process is starting: one at a time, since loading takes time."""
        busy = any(child.state not in SETTLED for child in children)
        if busy or any(spare.state == ProcessState.STARTING for spare in self.all):
            return
        for spare in self.all:
            if spare.state == ProcessState.WAITING or (spare.state == ProcessState.RESTARTING and now >= spare.due):
                spare.start(now)
                return
