"""Prints the OpenAPI document, from which the types of the front end are made: ``make types``."""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from app.launch.plan import plan_service, service_info
from app.launch.prepared import Prepared
from app.launch.sockets import open_sockets
from app.web.application import create_app
from vision_core.clock import Instant
from vision_core.rtdb.store import Store, create_block
from vision_core.venues.loader import layers_of, settings_from_layers


def document() -> dict[str, Any]:
    """The document of the default settings. No process is started."""
    layers = layers_of(options={"server.port": 0, "server.udp_port": 0})
    with tempfile.TemporaryDirectory() as folder:
        prepared = Prepared(settings_from_layers(layers), layers, Path(folder) / "venue.db", "default")
        sockets = open_sockets(prepared.settings.server)
        plan = plan_service(service_info(prepared, sockets, version="types", boot=Instant(1), restarts=0), sockets)
        for opened in plan.sockets.values():
            opened.close()
        store = Store(plan.records, create_block(plan.records))
        store.writer("service").write(plan.initial["service"], Instant(1), Instant(1))
        return create_app(store).openapi()


if __name__ == "__main__":
    json.dump(document(), sys.stdout, indent=1, sort_keys=True)
