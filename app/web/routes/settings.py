"""``/api/v1/settings``: every setting, changes with history, undo and redo, export and import."""

from typing import Any, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import ConfigDict

from app.web.auth.identity import identity_of
from app.web.configuration import sources
from app.web.configuration.catalog import SettingReport, catalog_of
from app.web.configuration.configuration import Configuration
from app.web.configuration.exchange import Export, changes_to, export_of
from app.web.configuration.keys import setting
from app.web.problems import REFUSED
from app.web.reports.base import Report
from app.web.reports.changes import ChangeReport, change_from, not_made
from app.web.routes.change import change
from vision_core.rtdb.infos import ServiceInfo

HISTORY = 200


class SettingsReport(Report):
    """Every setting, and what can be undone."""

    revision: int
    """Number of the newest change; a change that is sent with it is refused when somebody else was faster."""
    undo: str | None
    """What undo takes back; null: nothing."""
    redo: str | None
    """What redo makes again; null: nothing."""
    waits_for_restart: list[str]
    """Settings that were changed and take effect with the next start of the service."""
    notice: str
    """What happened to a damaged database, or why kept changes do not fit to the files; empty when all is well."""
    settings: list[SettingReport]


class SettingsPatch(Report):
    """New values by keys; null: as the files have it."""

    model_config = ConfigDict(extra="forbid")

    revision: int | None = None
    """Newest revision that was seen; null: whatever was changed since is replaced."""
    changes: dict[str, Any]


class Seen(Report):
    """The newest revision that was seen."""

    model_config = ConfigDict(extra="forbid")

    revision: int


class SourcesReport(Report):
    """Where images can come from."""

    revision: int
    """Number of the newest change of settings."""
    uri: str
    """The one that the settings choose."""
    running: str
    """The one with which the service runs."""
    choices: list[str]
    """The simulated camera, the two above, and every camera of this machine."""
    is_chosen_at_start: bool
    """The command line has chosen it: the settings cannot."""


def settings_routes(configuration: Configuration, service: ServiceInfo) -> APIRouter:
    """Reading and changing settings."""
    router = APIRouter(prefix="/api/v1", tags=["settings"])
    document = configuration.document

    @router.get("/settings")
    def settings() -> SettingsReport:
        """Every setting with its value, limits and description, and what can be undone."""
        undo, redo = document.undoable(), document.redoable()
        return SettingsReport(
            revision=configuration.revision,
            undo=undo.what if undo else None,
            redo=redo.what if redo else None,
            waits_for_restart=configuration.waiting_for_restart(),
            notice="; ".join(filter(None, (document.notice, configuration.refused_overlay))),
            settings=catalog_of(configuration),
        )

    @router.patch("/settings", responses=REFUSED)
    def change_settings(patch: SettingsPatch, request: Request) -> ChangeReport:
        """Changes settings. Those that can be are applied at the next frame; the others wait for a restart."""
        values = {setting(key): value for key, value in patch.changes.items()}
        what = f"set {', '.join(sorted(patch.changes))[:120]}"
        if sources.KEY in patch.changes:
            wanted = configuration.with_changes(values, what)
            if wanted.source.uri != configuration.settings.source.uri or sources.is_chosen_at_start(service):
                sources.check_source(wanted, service)
        return change(configuration, values, request, what, patch.revision)

    @router.get("/sources")
    def sources_() -> SourcesReport:
        """Sources of images to choose from; ``source.uri`` chooses one, which takes effect with the next start."""
        wanted, running = configuration.settings.source.uri, service.settings.source.uri
        return SourcesReport(
            revision=configuration.revision,
            uri=wanted,
            running=running,
            choices=sources.sources_with(running, wanted),
            is_chosen_at_start=sources.is_chosen_at_start(service),
        )

    @router.get("/settings/history")
    def history(limit: int = Query(default=HISTORY, ge=1, le=HISTORY)) -> list[ChangeReport]:
        """The newest changes with who, when, before and after, the newest first."""
        return [change_from(change) for change in document.history(limit)]

    @router.post("/settings/undo", responses=REFUSED)
    def undo(seen: Seen, request: Request) -> ChangeReport:
        """Takes the newest change back."""
        return change_from(configuration.undo(who=identity_of(request).name, seen=seen.revision))

    @router.post("/settings/redo", responses=REFUSED)
    def redo(seen: Seen, request: Request) -> ChangeReport:
        """Makes the change again that was taken back last."""
        return change_from(configuration.redo(who=identity_of(request).name, seen=seen.revision))

    @router.get("/settings/export")
    def export(response: Response) -> Export:
        """Everything that was changed on the page, as a file for another server. It holds no secrets."""
        response.headers["content-disposition"] = 'attachment; filename="pslv-settings.json"'
        return export_of(configuration.entries, service.version, service.venue)

    @router.post("/settings/import", responses=REFUSED)
    def import_(
        imported: Export, request: Request, preview: Literal["true", "false"] = Query(default="false")
    ) -> ChangeReport:
        """Makes everything as an exported file has it, as one change that can be undone; preview=true only tells what
        would change."""
        values = changes_to(imported, configuration.entries)
        if preview == "true":
            return not_made(configuration.revision, "import", configuration.preview(values, "import"))
        return change(configuration, values, request, "import")

    return router
