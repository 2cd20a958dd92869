"""Main module: a supervisor over sleepers, in a process of its own. Prints its log.

The arguments are the names of the sleepers; a number among them is the number of warm spares. "reader" prints what the
others print.
"""

import json
import os
import sys

from app.supervisor.plan import LOG, OUTPUT, ChildPlan, ServicePlan, log_sockets
from app.supervisor.supervisor import Supervisor
from vision_core import startup
from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.log_record import LOG as LOG_RECORD
from vision_core.rtdb.task import ORDINARY_MAX_RUN_S
from vision_core.scheduling.attachment import monotonic

ONCE = ("job", "attempt")
"""Names of sleepers that run once; the others wait for the first of them."""
AFTER = {"second": "first", "patient": "unborn"}
"""Sleepers that wait for another's first heartbeat, or its crash."""


def main(arguments: list[str]) -> int:
    names = [name for name in arguments if not name.isdigit()]
    count = sum(int(name) for name in arguments if name.isdigit())
    spares = tuple(f"spare-{number}" for number in range(1, count + 1))
    children = tuple(
        ChildPlan(
            name=name,
            module=startup.LOG_READER if name == "reader" else "tests.app.sleeper_process",
            wakes=(),
            writes=(),
            sockets=(LOG,) if name == "reader" else (),
            after=AFTER.get(name, "" if name in ONCE else next((once for once in ONCE if once in names), "")),
            once=name in ONCE,
            may_fail=name == "attempt",
            heartbeat_s=0.5,
            longest_run_s=ORDINARY_MAX_RUN_S if name == "thinker" else 0.5,
            spared=name not in ONCE,
        )
        for name in names
    )
    with_heartbeat = (*names, *spares)
    specs = (
        RecordSpec("processes", 16384, 0.0),
        LOG_RECORD.spec,
        *(RecordSpec(f"heartbeat/{name}", 8, 0.0) for name in with_heartbeat),
    )
    control = f"pslv/test-{os.getpid()}"
    log_end, output = log_sockets()
    plan = ServicePlan(
        children=children,
        records=specs,
        initial={},
        sockets={LOG: log_end, OUTPUT: output} if "reader" in names else {},
        boot=monotonic(),
        spares=spares,
        control=control,
        spare_module="tests.app.spare_process",
    )
    supervisor = Supervisor(plan, log, None)
    reader = supervisor._store.reader("processes")
    publish = supervisor._publish

    def publish_and_print(now: int) -> None:
        before = reader.sequence
        publish(now)
        if reader.sequence != before:
            reading = reader.read(monotonic())
            assert reading is not None
            log("processes " + json.dumps(json.loads(reading.value)["processes"]))

    supervisor._publish = publish_and_print  # type: ignore[method-assign]
    supervisor.start()
    supervisor.run(lambda: False)
    supervisor.stop()
    return supervisor.exit_status


def log(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
