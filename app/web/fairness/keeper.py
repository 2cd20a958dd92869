"""Keeps the report of every match: at its end, once a minute while it is played, and when the service stops."""

import asyncio
import sys

from app.web.blackboard import Blackboard
from app.web.fairness.kept import KeptReports
from app.web.reports.fairness import fairness_report
from vision_core.errors import ServiceError
from vision_core.types.fairness import PRACTICE
from vision_core.types.tables import Table

LOOK_EVERY_S = 1.0
KEEP_EVERY_S = 60.0
"""While a match is played: when the machine loses its power, at most so much of it is not on disk."""


class FairnessKeeper:
    """Looks for records that are worth keeping."""

    def __init__(self, blackboard: Blackboard, kept: KeptReports) -> None:
        self._blackboard = blackboard
        self._kept = kept
        self._ended = 0
        self._complaint = ""

    async def run(self) -> None:
        """Keep reports for as long as the web process runs."""
        looks = 0
        while True:
            await asyncio.to_thread(self.keep_ended)
            if looks % round(KEEP_EVERY_S / LOOK_EVERY_S) == 0:
                await asyncio.to_thread(self.keep_running)
            looks += 1
            await asyncio.sleep(LOOK_EVERY_S)

    def keep_ended(self) -> None:
        """Keep the record that has ended last, once."""
        sequence = self._blackboard.fairness_ended_number
        if sequence != self._ended:
            self._ended = sequence
            self._keep(self._blackboard.fairness_ended())

    def keep_running(self) -> None:
        """Keep the record that goes on, as far as it is."""
        self._keep(self._blackboard.fairness())

    def _keep(self, record: Table | None) -> None:
        """Keep a record unless it is of practice, or empty. A disk that does not take it is complained of once."""
        if record is None or record["reason"] == PRACTICE or not record["frames"].any():
            return
        try:
            self._kept.keep(fairness_report(record, tells_seed=True))
            self._complaint = ""
        except ServiceError as error:
            if str(error) != self._complaint:
                self._complaint = str(error)
                print(f"warning: {error}", file=sys.stderr)
