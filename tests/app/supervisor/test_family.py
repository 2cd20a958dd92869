"""What the processes of a plan share."""

from app.supervisor.family import Family
from app.supervisor.plan import ChildPlan, ServicePlan
from vision_core.rtdb import records
from vision_core.rtdb.layout import RecordSpec


def child(name: str, writes: tuple[str, ...], wakes: tuple[str, ...]) -> ChildPlan:
    return ChildPlan(
        name=name, module="m", wakes=wakes, writes=writes, sockets=(), after="", once=False,
        heartbeat_s=1.0, longest_run_s=1.0,
    )  # fmt: skip


def test_a_process_wakes_others_and_not_itself() -> None:
    children = (child("one", ("seen", "told"), ("seen",)), child("other", (), ("seen", "told")))
    heartbeats = [records.heartbeat(each.name) for each in children]
    specs = (RecordSpec("seen", 8, 1.0), RecordSpec("told", 8, 1.0), *heartbeats)
    plan = ServicePlan(
        children=children, records=specs, initial={}, sockets={}, boot=0, spares=(), control="", spare_module="m"
    )
    family = Family(plan)
    one, other = (each.resources for each in family.children)
    assert one.wake != other.wake
    assert one.notify == {"seen": (other.wake,), "told": (other.wake,)}
    assert other.notify == {}
    family.close()
