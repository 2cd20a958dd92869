"""Processes by name: of the supervisor's table, else as they call themselves."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

from vision_core.rtdb.layout import RecordSpec
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.attachment import monotonic
from vision_core.startup.process_names import MAX_KNOWN, ProcessNames, named_by_kernel

SPECS = (RecordSpec("processes", 16384, 3.0),)


@pytest.fixture
def store() -> Iterator[Store]:
    block = create_block(SPECS)
    made = Store(SPECS, block)
    yield made
    made.close()
    os.close(block)


def tell(store: Store, **pids: int | None) -> None:
    rows = [{"name": name.replace("_", "-"), "pid": pid} for name, pid in pids.items()]
    store.writer("processes").write(json.dumps({"processes": rows}).encode(), monotonic(), monotonic())


def test_a_process_is_named_as_the_newest_table_has_it(store: Store) -> None:
    names = ProcessNames(store.reader("processes"), lambda pid: f"stranger {pid}")
    assert names.of(7) == "stranger 7"
    tell(store, spare_1=7, perceive=8)
    assert (names.of(7), names.of(8)) == ("spare-1", "perceive")
    tell(store, spare_1=None, perceive=7)
    assert names.of(7) == "perceive"


def test_the_last_words_of_one_that_has_ended_are_still_its_own(store: Store) -> None:
    names = ProcessNames(store.reader("processes"))
    tell(store, perceive=7)
    assert names.of(7) == "perceive"
    tell(store, perceive=None)
    assert names.of(7) == "perceive"


def test_names_of_strangers_do_not_pile_up(store: Store) -> None:
    names = ProcessNames(store.reader("processes"), str)
    for pid in range(2 * MAX_KNOWN):
        names.of(pid)
    assert len(names._names) == MAX_KNOWN


def test_a_process_of_the_service_is_known_by_the_name_that_it_gave_itself() -> None:
    script = (
        "from vision_core.scheduling.attachment import name_process\n"
        "name_process('pslv:supervisor'); print('named', flush=True); input()"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as named:
        assert named.stdout is not None
        assert named.stdout.readline() == b"named\n"
        assert named_by_kernel(named.pid) == "supervisor"
        named.communicate(b"\n")
    assert named_by_kernel(named.pid) == f"process {named.pid}"
    assert named_by_kernel(os.getpid()) == f"process {os.getpid()}"
