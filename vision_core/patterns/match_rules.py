"""Rules that span a venue's match and its patterns: can every robot that may connect wear a marker of its own?"""

from collections.abc import Callable, Iterator

from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team


def match_warnings(settings: Settings, place_of: Callable[[str], str]) -> Iterator[str]:
    """One sentence per team whose robots, by their numbers, cannot all be recognized.

    The service works all the same; a robot without a marker may connect and sees nothing. place_of: names the file and
    line that set a key. Raises SettingsError for a pattern that cannot be read.
    """
    numbers = settings.match.numbers
    for team in Team:
        patterns = worn_patterns(settings.robots, team)
        known = sorted(number for pattern in patterns for number in pattern.code_by_id)
        names = " and ".join(repr(pattern.name) for pattern in patterns)
        has = f"pattern {names} of team {team} has {_listed(known)}"
        ids = settings.match.ids_of(team)
        if numbers > len(known):
            yield f"{place_of('match.numbers')}: match.numbers is {numbers}, but {has} alone"
        elif foreign := [marker_id for marker_id in ids[:numbers] if marker_id not in known]:
            key = f"match.{team}_ids"
            yield f"{place_of(key)}: {key} gives numbers 1 to {numbers} {_listed(foreign)}, but {has}"


def _listed(ids: list[int]) -> str:
    return f"{'id' if len(ids) == 1 else 'ids'} {', '.join(map(str, ids))}"
