"""Programs in a process of their own, with the compiler on or off."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import coadapt as ca

ROOT = Path(__file__).parents[2]


def run_apart(program: str, **environment: str) -> dict[str, Any]:
    """What ``program``, which may import `coadapt` and `tests`, prints as JSON."""
    source = str(Path(ca.__file__).parents[1])
    path = os.pathsep.join([source, str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": path, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    return json.loads(done.stdout)
