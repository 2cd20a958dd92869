"""A match: players of both teams, the score every second, and the processor time of the service."""

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from vision_core.client.play.game import Page, Score
from vision_core.client.play.players import Player
from vision_core.errors import PslvError

SAMPLE_S = 1.0
CONNECT_S = 30.0
"""All players must be connected within."""


@dataclass(frozen=True, slots=True)
class Match:
    """How a match went."""

    duration_s: float
    scores: tuple[Score, ...]
    """One a second, since the beginning."""
    players: tuple[Player, ...]
    service_cpu_s: float | None
    """Processor time of the service's processes; None: it runs on another computer."""

    @property
    def final(self) -> Score:
        return self.scores[-1]

    @property
    def controllers_cpu_s(self) -> float:
        """Processor time of all players: of their clients and controllers."""
        return sum(player.count.cpu_s for player in self.players)


def play(players: Sequence[Player], page: Page, duration_s: float, show: Callable[[float, Score], None]) -> Match:
    """Play for a time [s]. show: is told every second how long it has been going on, and the score.

    The first player that fails ends the match. Raises PslvError with its reason, or what a controller has raised.
    """
    stop = threading.Event()
    with ThreadPoolExecutor(len(players), thread_name_prefix="player") as threads:
        try:
            running = [threads.submit(player.play, stop) for player in players]
            _wait_until_connected(players, running)
            return _watch(players, running, page, duration_s, show)
        finally:
            stop.set()


def _wait_until_connected(players: Sequence[Player], running: Sequence["Future[None]"]) -> None:
    deadline_s = time.monotonic() + CONNECT_S
    for player in players:
        while not player.is_connected.wait(0.05):
            _raise_first(running)
            if time.monotonic() > deadline_s:
                raise PslvError(f"{player.team} {player.number}", found=f"no connection within {CONNECT_S:g} s")


def _watch(
    players: Sequence[Player],
    running: Sequence["Future[None]"],
    page: Page,
    duration_s: float,
    show: Callable[[float, Score], None],
) -> Match:
    processes = page.processes()
    began, began_s, cpu_s = page.score(), time.monotonic(), service_cpu_s(processes)
    scores = [began.since(began)]
    while (gone_s := time.monotonic() - began_s) < duration_s:
        show(gone_s, scores[-1])
        time.sleep(min(SAMPLE_S, duration_s - gone_s))
        _raise_first(running)
        scores.append(page.score().since(began))
    ended_cpu_s = service_cpu_s(processes)
    used_s = None if cpu_s is None or ended_cpu_s is None else ended_cpu_s - cpu_s
    return Match(time.monotonic() - began_s, tuple(scores), tuple(players), used_s)


def _raise_first(running: Iterable["Future[None]"]) -> None:
    """Raise what a player has raised that has ended."""
    for player in running:
        if player.done():
            player.result()


def service_cpu_s(processes: Iterable[int]) -> float | None:
    """Processor time that processes of this machine have used so far [s]; None when none of them is here."""
    used = []
    for pid in processes:
        with contextlib.suppress(OSError, ValueError, IndexError):
            fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
            used.append((int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
    return sum(used) if used else None
