"""What ``pslv onboard edges`` says of each picture."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from vision_core.errors import PslvError, SourceError

if TYPE_CHECKING:
    from vision_core.client.recognition import Palette, PictureGeometry, Placement
    from vision_core.models.mirror import Mirror


def edges_in(
    files: list[Path],
    mirror: "Mirror",
    placement: "Placement",
    palette: "Palette",
    *,
    draw: Path | None,
    as_json: bool,
) -> Iterator[str]:
    """One line for every picture of the files. The mirror's place is found anew when the size of pictures changes.

    Raises SettingsError and SourceError, the latter with the name of the picture.
    """
    from vision_core.client.__main__ import plain_from_view
    from vision_core.client.recognition import recognize
    from vision_core.native.opencv import write_picture
    from vision_core.onboard.overlay import draw_recognized
    from vision_core.onboard.pictures import open_pictures

    if draw is not None:
        _make_folder(draw)
    geometry: PictureGeometry | None = None
    for file in files:
        for number, picture in enumerate(open_pictures(file)):
            try:
                if geometry is None or geometry.size_px != picture.shape[1::-1]:
                    geometry = placement.geometry(picture, mirror, palette)
                recognized = recognize(picture, geometry, palette)
            except SourceError as error:
                raise SourceError(f"{file}, picture {number}: {error}") from None
            view = recognized.view(mirror)
            found = {"file": str(file), "picture": number} | plain_from_view(view)
            yield json.dumps(found) if as_json else f"{file}, picture {number}: {view.summary}"
            if draw is not None:
                write_picture(draw / f"{file.stem}-{number:04d}.png", draw_recognized(picture, recognized, geometry))


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PslvError(f"--draw {folder}", found=error.strerror or str(error), accepted="a folder") from None
