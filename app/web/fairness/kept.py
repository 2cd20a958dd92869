"""Impartiality reports on disk: one file of JSON for each record, in the folder ``fairness`` beside the database."""

import re
import time
from http import HTTPStatus
from pathlib import Path

from pydantic import ValidationError

from app.web.problems import RequestRefused
from app.web.reports.base import Report
from app.web.reports.fairness import FairnessReport
from vision_core.errors import ServiceError, SourceError
from vision_core.user_files import read_text

FOLDER = "fairness"
ENDING = ".json"
NAME = re.compile(r"\d{8}-\d{6}(-[a-z0-9-]{1,80})?")
MAX_BYTES = 4 << 20
MAX_LISTED = 100


class KeptReport(Report):
    """A report that was kept."""

    name: str
    """To ask for it: ``?record=NAME``."""
    size: int
    """Of its file [bytes]."""


class KeptReports:
    """The reports of a service."""

    def __init__(self, database: Path) -> None:
        """database: file beside which they lie."""
        self.folder = database.parent / FOLDER

    def keep(self, report: FairnessReport) -> Path:
        """Write a report, in place of an earlier one of the same record; all of it or nothing. Raises ServiceError."""
        path = self.folder / f"{name_of(report)}{ENDING}"
        try:
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            half = path.with_suffix(".part")
            half.write_text(report.model_dump_json(indent=1), encoding="utf-8")
            half.replace(path)
        except OSError as error:
            raise ServiceError(f"impartiality report {path}", found=error.strerror or str(error)) from None
        return path

    def names(self) -> list[KeptReport]:
        """The newest reports, the newest first."""
        found = sorted((path for path in self.folder.glob(f"*{ENDING}") if NAME.fullmatch(path.stem)), reverse=True)
        return [KeptReport(name=path.stem, size=path.stat().st_size) for path in found[:MAX_LISTED]]

    def read(self, name: str) -> FairnessReport:
        """A report that was kept. Raises RequestRefused when there is none of this name."""
        path = self.folder / f"{name}{ENDING}"
        if not NAME.fullmatch(name) or not path.is_file():
            accepted = ", ".join(kept.name for kept in self.names()[:5]) or "none was kept yet"
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, "impartiality report", found=name[:100], accepted=accepted, field="record"
            )
        try:
            return FairnessReport.model_validate_json(read_text(path, str(path), SourceError, max_bytes=MAX_BYTES))
        except (ValidationError, SourceError) as error:
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, "impartiality report", found=f"{name}: {error}"[:200], accepted="another one"
            ) from None


def name_of(report: FairnessReport) -> str:
    """When the record began, and who played: 20261130-143000-graz-koeln."""
    began = time.strftime("%Y%m%d-%H%M%S", time.localtime(report.record.began_s))
    names = re.sub(r"[^a-z0-9]+", "-", "-".join(team.name for team in report.teams).lower()).strip("-")[:60]
    return f"{began}-{names}".rstrip("-")
