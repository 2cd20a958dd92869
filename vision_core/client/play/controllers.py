"""What a controller is, and how one is found by its name."""

import importlib
import importlib.util
import inspect
import sys
from pathlib import Path
from types import ModuleType
from typing import Protocol, cast

from vision_core.client.driving import Robot
from vision_core.client.view import View
from vision_core.errors import SourceError
from vision_core.protocol.driving import Drive
from vision_core.protocol.options import PAPER_OPTIONS, Options

SHIPPED = {"chase": "chase_ball.py:ChaseBall", "keeper": "keep_goal.py:KeepGoal"}
"""The example controllers: files of the folder ``examples``, and their classes."""
ACCEPTED = f"{', '.join(SHIPPED)}, MODULE:CLASS or FILE.py:CLASS; the class has decide(view)"


class Controller(Protocol):
    """Drives one robot by its views. May have ``options``: which views it asks for."""

    def decide(self, view: View) -> Drive:
        """What the robot does from now on."""
        ...


class ControllerKind(Protocol):
    """A class of controllers."""

    def __call__(self, robot: Robot, /) -> Controller: ...


def examples_folder() -> Path:
    """The shipped examples: inside the wheel, or beside the package in a checkout."""
    package = Path(__file__).parents[2]
    inside = package / "examples"
    return inside if inside.is_dir() else package.parent / "examples"


def load_controller(name: str) -> ControllerKind:
    """The class of a controller. Raises SourceError."""
    place, _, kind = SHIPPED.get(name, name).rpartition(":")
    if name in SHIPPED:
        place = str(examples_folder() / place)
    if not place or not kind:
        raise SourceError("a controller", found=repr(name), accepted=ACCEPTED)
    found = getattr(_module(name, place), kind, None)
    if not inspect.isclass(found) or not callable(getattr(found, "decide", None)):
        raise SourceError(f"controller {name}", found=f"no class {kind} with decide(view)", accepted=ACCEPTED)
    return cast("ControllerKind", found)


def options_of(kind: ControllerKind) -> Options:
    """Which views a controller asks for."""
    asked = getattr(kind, "options", PAPER_OPTIONS)
    if not isinstance(asked, Options):
        raise SourceError("options of a controller", found=repr(asked), accepted="Options(types=...)")
    return asked


def _module(name: str, place: str) -> ModuleType:
    """The module of a controller, by its name or its file. Raises SourceError when there is none."""
    try:
        if not place.endswith(".py"):
            sys.path.insert(0, str(Path.cwd()))
            try:
                return importlib.import_module(place)
            finally:
                sys.path.pop(0)
        spec = importlib.util.spec_from_file_location(f"pslv_controller_{Path(place).stem}", place)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
        return module
    except (ImportError, OSError, SyntaxError) as error:
        raise SourceError(f"controller {name}", found=str(error), accepted=ACCEPTED) from None
