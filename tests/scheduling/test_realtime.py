"""What a process asks of the kernel: as root it gets it, without rights it is told why not."""

import json
import os
import subprocess
import sys

import pytest

from tests.conftest import ROOT

PROBE = """
import json, os, resource
from vision_core.scheduling.realtime import ask_priority, lock_memory, stay_on
if {drop}:
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (65536, 65536))
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    os.setgroups([]); os.setgid(65534); os.setuid(65534)
granted, memory = ask_priority(7), lock_memory()
child = os.fork()
if child == 0:
    os._exit(os.sched_getscheduler(0))
child_policy = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
refusals = [granted.refusal, memory, stay_on([1022]), stay_on([])]
print(json.dumps([granted.policy, *(str(each or "") for each in refusals), child_policy, ask_priority(0).policy]))
"""


def probed(*, drop: bool) -> list[object]:
    """What a process of its own gets, with our rights or without any."""
    code = PROBE.replace("{drop}", str(drop))
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    found: list[object] = json.loads(done.stdout)
    return found


needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="rights can be given up by root only")


@needs_root
def test_with_rights_it_gets_real_time_and_its_children_do_not_inherit_it() -> None:
    policy, refused, memory, cores, anywhere, child_policy, back = probed(drop=False)
    if policy != "FIFO 7":
        pytest.skip(f"root without rights: {refused}")
    assert (refused, memory) == ("", "")
    assert child_policy == os.SCHED_OTHER
    assert str(cores).startswith("running on cores 1022 is refused")
    assert (anywhere, back) == ("", "ordinary")


@needs_root
def test_without_rights_every_refusal_is_told() -> None:
    policy, refused, memory, _, _, child_policy, _ = probed(drop=True)
    nice = os.getpriority(os.PRIO_PROCESS, 0)
    assert policy == (f"nice {nice}" if nice else "ordinary")
    assert refused == "SCHED_FIFO 7 is refused: no CAP_SYS_NICE, and ulimit -r is 0"
    assert memory == "locking memory is refused: no CAP_IPC_LOCK, and ulimit -l is 64 KiB"
    assert child_policy == os.SCHED_OTHER
