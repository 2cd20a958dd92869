"""Process: answers init with ``(error not_ready)`` while the task ``serve`` does not run.

That is so while kernels are compiled, while ``serve`` starts, and when it is disabled. The supervisor, which owns the
sockets, must not read what strangers send; this small process may. While ``serve`` writes its record, this process does
not read from the sockets.
"""

import select
import time

from vision_core.clock import MonotonicClock
from vision_core.net.not_ready import NotReadyResponder
from vision_core.net.udp import SharedSocket, adopted
from vision_core.scheduling.attachment import attach

SERVING = "serving"
"""Record that the task serve writes twice a second."""
TURN_S = 0.1


def main() -> None:
    """Run until the supervisor says stop."""
    attachment = attach()
    clock = MonotonicClock()
    sockets = [SharedSocket(adopted(attachment.resources.sockets[name])) for name in ("main", "session")]
    responder = NotReadyResponder(sockets)
    serving = attachment.store.reader(SERVING)
    while not attachment.stopping:
        now = clock.now()
        attachment.heartbeat(now)
        reading = serving.read(now)
        if reading is not None and reading.valid:
            time.sleep(TURN_S)
        elif select.select(sockets, [], [], TURN_S)[0]:
            responder.answer_pending(clock.now())
    for shared in sockets:
        shared.socket.close()


if __name__ == "__main__":
    main()
