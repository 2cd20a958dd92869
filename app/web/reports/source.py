"""Where the images come from."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records


class SourceReport(Report):
    """Where the images come from."""

    uri: str
    """As in the settings: "synthetic", "file:PATH" or "camera:DEVICE"."""
    description: str
    repeats: bool
    """The same images come again: a still picture, or a recording in a loop."""


def source_from(snapshot: ServiceSnapshot) -> SourceReport | None:
    """The source; None before it was opened."""
    source = snapshot.of(records.source)
    if source is None:
        return None
    return SourceReport(uri=source.value.uri, description=source.value.description, repeats=source.value.repeats)
