"""Which settings a running service applies between two frames. Every other one needs a restart."""

LIVE = ("match", "mirror", "tracks", "views", "admission", "faults")
"""Sections of which every setting is live."""
LIVE_KEYS = ("colors.light.adapt",)
"""Single live settings of other sections."""
LIVE_OF_TASKS = ("enabled", "period_ms", "priority", "rehearse")
"""Settings of each task that are live."""
UNUSED = "camera.lens"
"""No process reads it: calibrations begin with the newest settings."""


def is_live(key: str) -> bool:
    """Does a change of a setting hold from the next frame on? key: dotted, "match.blue_defends"."""
    section, *rest = key.split(".")
    if section == "tasks":
        return len(rest) == 2 and rest[1] in LIVE_OF_TASKS
    return section in LIVE or key in LIVE_KEYS or key.startswith(UNUSED)
