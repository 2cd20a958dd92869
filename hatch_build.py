"""Build hook: the built page goes into wheel and sdist. From a git checkout it is built first; sdists hold it."""

import importlib.util
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageHook(BuildHookInterface):  # type: ignore[type-arg]
    """Builds web/dist, unless a fresh one is there. Fails loudly: a wheel without its page is of no use."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":  # `pslv serve` in a checkout builds the page beside the kernels
            return
        root = Path(self.root)
        if (root / "web" / "src").is_dir():
            self._builder(root).build()
        dist = root / "web" / "dist"
        if not (dist / "index.html").is_file():
            raise RuntimeError(f"{dist} is missing: python web/build.py builds it")
        build_data["force_include"][str(dist)] = "app/web/static" if self.target_name == "wheel" else "web/dist"

    @staticmethod
    def _builder(root: Path) -> Any:
        spec = importlib.util.spec_from_file_location("pslv_web_build", root / "web" / "build.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
