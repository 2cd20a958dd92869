"""Acts of a trial that are shorter than for people."""

from collections.abc import Mapping

import pytest

Durations = Mapping[str, Mapping[str, float]]

FOR_ROBOTS: Durations = {
    "opening": {"DEAF_S": 1.0, "NOT_READY_S": 1.0, "OPEN_S": 1.0, "FAIR_S": 0.2},
    "acts": {
        "FAIR_S": 0.2,
        "FOUL_S": 0.5,
        "UNSEEN_S": 0.6,
        "CUT_S": 0.4,
        "MIRROR_S": 0.5,
        "PING_S": 0.3,
        "GAP_S": 0.08,
        "LEASE_S": 0.8,
    },
    "server": {"LEASE_S": 0.8},
    "ends": {"FAIR_S": 0.2, "DOWN_S": 0.2, "BACK_S": 1.5, "REPLACED_S": 0.6},
}
"""For clients of tests, which ask three times a second."""
FOR_PROGRAMS: Durations = {
    "opening": {"DEAF_S": 1.6, "FAIR_S": 0.3},
    "acts": {"FAIR_S": 0.3, "FOUL_S": 1.0, "UNSEEN_S": 0.3, "CUT_S": 0.3, "MIRROR_S": 0.3, "LEASE_S": 2.0},
    "server": {"LEASE_S": 2.0},
    "ends": {"FAIR_S": 0.3, "DOWN_S": 0.5, "REPLACED_S": 1.5},
}
"""For those that are shipped."""


def shorten(monkeypatch: pytest.MonkeyPatch, durations: Durations) -> None:
    for module, constants in durations.items():
        for name, value in constants.items():
            monkeypatch.setattr(f"vision_core.examination.trial.{module}.{name}", value)
