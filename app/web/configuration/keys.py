"""Keys of the document's entries."""

from vision_core.types.objects import Team

SETTING = "settings/"
"""A value that replaces one of the settings: ``settings/match.blue_defends``."""
TEAM = "teams/"
"""A registered team, by its short name in small letters: ``teams/cologne``."""
PLAYS = "plays/"
"""Which registered team plays a color: ``plays/blue``."""
ADMISSION = "admissions/"
"""An address or subnet that may connect: ``admissions/7``."""
REFUSAL = "refusals/"
"""An address that is turned away: ``refusals/192.168.1.7``."""
KINDS = (SETTING, TEAM, PLAYS, ADMISSION, REFUSAL)


def setting(key: str) -> str:
    """The entry of a setting."""
    return f"{SETTING}{key}"


def plays(color: Team) -> str:
    """The entry of the team that plays a color."""
    return f"{PLAYS}{color.value}"
