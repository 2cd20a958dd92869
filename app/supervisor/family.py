"""The memory, the events and the processes of one plan: what the supervisor has before anything runs."""

import os
from collections.abc import Mapping

from app.supervisor.child import Child
from app.supervisor.plan import LOG, OUTPUT, ChildPlan, ServicePlan
from app.supervisor.spares import Spares, spare_plans
from vision_core.rtdb.slots import SlotReader
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.attachment import HEARTBEAT, ChildResources, monotonic


class Family:
    """The processes of a plan with what they share."""

    def __init__(self, plan: ServicePlan) -> None:
        self._plan = plan
        self._block = create_block(plan.records)
        self.read_only_block = os.open(f"/proc/self/fd/{self._block}", os.O_RDONLY | os.O_CLOEXEC)
        """Descriptor of the database for who may only read."""
        self.store = Store(plan.records, self._block)
        self.write(plan.initial)
        self._events = {child.name: os.eventfd(0, os.EFD_NONBLOCK) for child in plan.children if child.wakes}
        self.children = [
            Child(child, self._resources(child), self._heartbeat(child), output=self._output(child))
            for child in plan.children
        ]
        self.spares = Spares([self._spare(spare) for spare in spare_plans(plan)])
        self.all = (*self.children, *self.spares.all)

    def write(self, values: Mapping[str, bytes]) -> None:
        """Write records before the processes run that write them."""
        for name, value in values.items():
            self.store.writer(name).write(value, monotonic(), monotonic())

    def close(self) -> None:
        """Give the memory and the events back. No process may run any more."""
        self.store.close()
        for descriptor in (self._block, self.read_only_block, *self._events.values()):
            os.close(descriptor)

    def _resources(self, plan: ChildPlan) -> ChildResources:
        """What a child is given. Its own event is raised by others only: it knows what it has written."""
        others = [child for child in self._plan.children if child is not plan]
        notify = {
            record: tuple(self._events[other.name] for other in others if record in other.wakes)
            for record in plan.writes
        }
        return ChildResources(
            process=plan.name,
            supervisor=os.getpid(),
            boot=self._plan.boot,
            block=self._block,
            records=self._plan.records,
            wake=self._events.get(plan.name),
            notify={record: events for record, events in notify.items() if events},
            sockets={name: self._plan.sockets[name].fileno() for name in plan.sockets},
        )

    def _heartbeat(self, plan: ChildPlan) -> SlotReader:
        return self.store.reader(f"{HEARTBEAT}/{plan.name}")

    def _output(self, plan: ChildPlan) -> int | None:
        """Where a child prints."""
        output = self._plan.sockets.get(OUTPUT)
        return None if output is None or LOG in plan.sockets else output.fileno()

    def _spare(self, plan: ChildPlan) -> Child:
        """A spare may become any child: it inherits every descriptor, and imports the main module of every child."""
        modules = dict.fromkeys(child.module for child in self._plan.children if child.spared)
        sockets = [self._plan.sockets[name].fileno() for child in self._plan.children for name in child.sockets]
        return Child(
            plan,
            self._resources(plan),
            self._heartbeat(plan),
            arguments=tuple(modules),
            inherits=(*self._events.values(), *sockets),
            output=self._output(plan),
            is_spare=True,
        )
