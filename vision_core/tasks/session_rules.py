"""The rules of the UDP sessions, from the settings and from what the service knows of itself."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from vision_core.clock import MS_PER_S
from vision_core.models.field import diagonal_m
from vision_core.models.from_settings import mirrors_of
from vision_core.models.mirror import MM_PER_M
from vision_core.net.udp import adopted
from vision_core.protocol.admission import Admission
from vision_core.protocol.driving import DriveLimits
from vision_core.protocol.lifecycle import Port
from vision_core.protocol.options import Options
from vision_core.protocol.rules import ServerFacts, SessionRules
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle
from vision_core.settings.schema import SYNTHETIC, MatchViews, Settings
from vision_core.types.objects import Team
from vision_core.views.renderer import nearest_m

NO_KEYS: Mapping[str, str] = MappingProxyType({})


class RuleBook:
    """Makes the rules of a service's sessions."""

    def __init__(self, handle: Handle) -> None:
        self._handle = handle
        sockets = handle.attachment.resources.sockets
        self.sockets = adopted(sockets["main"]), adopted(sockets["session"])
        """The bound sockets of the main and the session port."""

    def rules(
        self, settings: Settings, keys: Mapping[str, str] = NO_KEYS, monitor_key: str | None = None
    ) -> SessionRules:
        """keys: the digest of each team's key, by team. monitor_key: that of the monitors'."""
        return SessionRules(
            boot=self._handle.attachment.boot,
            numbers=settings.match.numbers,
            lease_s=settings.protocol.lease_s,
            diagonal_m=diagonal_m(settings.field),
            mirrors=mirrors_of(settings.mirror),
            admission=_admission(settings),
            facts=self._facts(settings),
            fixed=_fixed(settings.match.views) if settings.match.fixes_views else None,
            drives=drives_of(settings),
            keys={Team(team): digest for team, digest in keys.items()},
            monitor_key=monitor_key,
        )

    def _facts(self, settings: Settings) -> ServerFacts:
        """What the server tells of itself."""
        service = self._handle.reader(records.SERVICE).read(self._handle.clock.now())
        main, session = (int(one.getsockname()[1]) for one in self.sockets)
        return ServerFacts(
            ports={Port.MAIN: main, Port.SESSION: session},
            period_ms=MS_PER_S / settings.camera.rate_hz,
            rmin_mm={team: MM_PER_M * nearest_m(settings, team) for team in Team},
            venue=service.value.venue if service else settings.field_preset,
            field_mm=(MM_PER_M * settings.field.length_m, MM_PER_M * settings.field.width_m),
        )


def _fixed(views: MatchViews) -> Options:
    """What a match fixes."""
    return Options(
        types=views.types,
        fov_deg=views.fov_deg,
        center_deg=views.center_deg,
        resolution_deg=views.resolution_deg,
        rate_hz=views.rate_hz or None,
    )


def drives_of(settings: Settings) -> dict[tuple[Team, int], DriveLimits]:
    """What clients may ask of which robots: those of the simulated match."""
    if settings.source.uri != SYNTHETIC:
        return {}
    drive = settings.synthetic.drive
    limits = DriveLimits(drive.speed_m_s, drive.sideways_m_s, drive.turn_rad_s, drive.kick_m_s, drive.dribbler)
    numbers = range(1, settings.synthetic.robots_per_team + 1)
    return {(team, number): limits for team in Team for number in numbers}


def _admission(settings: Settings) -> Admission:
    """Who may connect as the settings say. In a match nobody may whom they do not list."""
    listed, in_practice = settings.admission, settings.match.mode == "practice"
    rules = ((rule.network, Team(rule.team) if rule.team else None, rule.number) for rule in listed.rules)
    admission = Admission.from_texts(listed.subnets, rules, listed.refused)
    return replace(admission, loopback=in_practice, open_practice=listed.open_practice and in_practice)
