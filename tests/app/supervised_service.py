"""Main module: a supervisor over sleepers, in a process of its own. Tells its news on standard output."""

import json
import sys

from app.supervisor.plan import ChildPlan, ServicePlan
from app.supervisor.service import Supervisor
from vision_core.rtdb.attachment import monotonic
from vision_core.rtdb.layout import RecordSpec


def main(names: list[str]) -> int:
    children = tuple(
        ChildPlan(
            name=name,
            module="tests.app.sleeper_process",
            trigger=None,
            writes=(),
            sockets=(),
            after_compile="job" in names and name != "job",
            once=name == "job",
            heartbeat_s=0.5,
        )
        for name in names
    )
    specs = (RecordSpec("processes", 16384, 0.0), *(RecordSpec(f"task/{name}", 64, 0.0) for name in names))
    plan = ServicePlan(children, specs, {}, {}, monotonic())
    supervisor = Supervisor(plan, tell, tell)
    reader = supervisor._store.reader("processes")
    publish = supervisor._publish

    def publish_and_print() -> None:
        publish()
        reading = reader.read(monotonic())
        assert reading is not None
        tell("processes " + json.dumps(json.loads(reading.value)["processes"]))

    supervisor._publish = publish_and_print  # type: ignore[method-assign]
    return supervisor.run()


def tell(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
