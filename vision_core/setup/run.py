"""Does the jobs of setting up a venue. No job changes a draft."""

from pathlib import Path

from vision_core.calibration.result import Progress
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.native.opencv import encode_jpeg, read_picture, shrink
from vision_core.regions.picture_kind import kind_reasons
from vision_core.setup.camera import find_camera
from vision_core.setup.choices import with_sample
from vision_core.setup.colors import class_map, find_all_colors, sample_at
from vision_core.setup.findings import Looked, Picked
from vision_core.setup.jobs import FindCamera, FindColors, Look, MapClasses, Pick, Recognize, SetupJob, Show
from vision_core.setup.recognize import recognize_field
from vision_core.setup.trial import try_venue
from vision_core.setup.venue_file import settings_of
from vision_core.venues.presets import shipped_fields

SHOWN_QUALITY = 92


def run(job: SetupJob, progress: Progress) -> object:
    """What a job finds, as the job says. Raises SourceError for pictures that cannot be used, SettingsError for
    a draft that is not complete enough, and what progress raises."""
    match job:
        case Look():
            return look_at(Path(job.picture), job.name, job.size_px, needs_color=job.needs_color)
        case Show():
            return encode_jpeg(shrink(read_picture(Path(job.picture)), job.width_px), SHOWN_QUALITY)
        case Recognize():
            return recognize_field(
                _read(job.pictures),
                shipped_fields(),
                marker_height_m=job.marker_height_m,
                height_m=job.height_m,
                progress=progress,
            )
        case FindCamera():
            return find_camera(job.draft, _read(job.pictures), job.wish, progress)
        case FindColors():
            return find_all_colors(job.draft, _read(job.pictures), progress)
        case Pick():
            pixels = read_picture(Path(job.picture))
            sampled = sample_at(job.draft, pixels, job.place_px, job.radius_px)
            return Picked(sampled, class_map(with_sample(job.draft, job.name, sampled.color), pixels))
        case MapClasses():
            return class_map(job.draft, read_picture(Path(job.picture)))
        case _:
            settings = settings_of(job.draft, complete=True)
            return try_venue([Path(name) for name in job.pictures], settings, job.in_use, Path(job.folder), progress)


def look_at(path: Path, name: str, size_px: tuple[int, int] | None, *, needs_color: bool) -> Looked:
    """Size of a picture. name: what messages call it; size_px: width and height that it must have; None: any.

    Raises SourceError when it cannot be read, has another size, or is none in color
    although it must be.
    """
    try:
        pixels = read_picture(path)
    except SourceError as error:
        raise SourceError(f"picture {name}", found=error.found, accepted=error.accepted) from None
    size = pixels.shape[1], pixels.shape[0]
    if size_px is not None and size != size_px:
        accepted = f"{size_px[0]}x{size_px[1]} as the first picture: one camera, at one resolution"
        raise SourceError(f"picture {name}", found=f"{size[0]}x{size[1]} px", accepted=accepted)
    for reason in kind_reasons(pixels) if needs_color else ():
        raise SourceError(f"picture {name}", found=reason.text, accepted=f"a picture in color. {reason.advice}")
    return Looked(*size)


def _read(names: tuple[str, ...]) -> list[Bytes]:
    return [read_picture(Path(name)) for name in names]
