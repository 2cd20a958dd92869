"""The score of a simulated match, as the service's page tells it."""

import json
import urllib.error
import urllib.request
from dataclasses import dataclass
from typing import Any

from vision_core.errors import ServiceError

TIMEOUT_S = 5.0


@dataclass(frozen=True, slots=True)
class Score:
    """What has happened since the service began to count, or since an earlier score."""

    played_s: float
    goals: tuple[int, int]
    """Of blue and yellow, as everywhere here."""
    possession_s: tuple[float, float]
    collisions: int

    def since(self, earlier: "Score") -> "Score":
        """What has happened after an earlier score. A game that was begun anew in between counts from its beginning."""
        if self.played_s < earlier.played_s:
            return self
        return Score(
            self.played_s - earlier.played_s,
            (self.goals[0] - earlier.goals[0], self.goals[1] - earlier.goals[1]),
            (self.possession_s[0] - earlier.possession_s[0], self.possession_s[1] - earlier.possession_s[1]),
            self.collisions - earlier.collisions,
        )

    @property
    def blue_share(self) -> float:
        """Of the time in which some team possessed the ball, 0..1; an even half before."""
        both = sum(self.possession_s)
        return self.possession_s[0] / both if both else 0.5

    @property
    def collisions_per_minute(self) -> float:
        return 60.0 * self.collisions / self.played_s if self.played_s else 0.0


class Page:
    """The service's page, at "http://127.0.0.1:8000"."""

    def __init__(self, address: str) -> None:
        self._address = address.rstrip("/")

    def score(self) -> Score:
        """The score now. Raises ServiceError."""
        game = self._get("/api/v1/game")
        teams = game["blue"], game["yellow"]
        return Score(
            float(game["played_s"]),
            (int(teams[0]["goals"]), int(teams[1]["goals"])),
            (float(teams[0]["possession_s"]), float(teams[1]["possession_s"])),
            int(game["collisions"]),
        )

    def processes(self) -> tuple[int, ...]:
        """Process ids of the service. Raises ServiceError."""
        return tuple(one["pid"] for one in self._get("/api/v1/status")["processes"] if one["pid"] is not None)

    def _get(self, path: str) -> Any:
        asked = f"{self._address}{path}"
        try:
            with urllib.request.urlopen(asked, timeout=TIMEOUT_S) as answer:  # noqa: S310 (of our own service)
                return json.load(answer)
        except urllib.error.HTTPError as error:
            raise ServiceError(asked, found=f"{error.code} {_reason(error)}", accepted="a simulated match") from None
        except (OSError, ValueError) as error:
            found = str(getattr(error, "reason", error))
            raise ServiceError(asked, found=found, accepted="the page of a service that runs: pslv serve") from None


def _reason(error: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(error)["detail"])
    except (OSError, ValueError, KeyError, TypeError):
        return error.reason
