"""Warm spares: processes that have loaded everything and wait for a place to take."""

from collections.abc import Iterable, Sequence

from app.supervisor.child import SETTLED, Child
from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.clock import NS_PER_S

SILENCE_S = 2.0
"""A spare that has not beaten for so long is hung,"""
FRESH_S = 0.5
"""and one that has not for so long takes no place: it beats ten times a second."""


def spare_plans(plan: ServicePlan) -> tuple[ChildPlan, ...]:
    """The processes that wait."""
    return tuple(
        ChildPlan(
            name=name,
            module=plan.spare_module,
            wakes=(),
            writes=(),
            sockets=(),
            after_compile=True,
            once=False,
            heartbeat_s=SILENCE_S,
            longest_run_s=SILENCE_S,
            spared=False,
        )
        for name in plan.spares
    )


class Spares:
    """The spares of a service. They may all be dead: a child is then started cold."""

    def __init__(self, spares: Sequence[Child]) -> None:
        self.all = tuple(spares)

    def take_place(self, child: Child, now: int) -> Child | None:
        """Have a spare become a child; which one, or None when no spare is ready."""
        if not child.plan.spared:
            return None
        for spare in self.all:
            fresh = now - spare.last_heartbeat < FRESH_S * NS_PER_S
            if spare.state == "running" and fresh and not spare.has_ended() and spare.hand_over(child, now):
                return spare
        return None

    def refill(self, children: Iterable[Child], now: int) -> None:
        """When all is quiet, start a spare that is missing: one at a time, since loading is work."""
        busy = any(child.state not in SETTLED for child in children)
        if busy or any(spare.state == "starting" for spare in self.all):
            return
        for spare in self.all:
            if spare.state == "waiting" or (spare.state == "restarting" and now >= spare.due):
                spare.start(now)
                return
