"""Options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

Venue = Annotated[
    str | None, typer.Option(envvar="PSLV_VENUE", help="A venue: a name of config/venues, or a .toml file.")
]
ConfigFile = Annotated[
    Path | None, typer.Option("--config", envvar="PSLV_CONFIG", help="A further file of settings, over the venue.")
]
