"""What this process has used so far, as far as the system tells."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path


def peak_memory_mb() -> float | None:
    """The most memory this process has held, in MB of 2**20 bytes; None where nobody counts."""
    if sys.platform == "win32":
        return None
    import resource

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1 << 20 if sys.platform == "darwin" else 1 << 10)


def seconds_since_launch() -> float | None:
    """Since this process was created, to a hundredth of a second; None except on Linux."""
    if sys.platform != "linux":
        return None
    # Behind the program's name, which may hold blanks: field 22 counts ticks since boot.
    fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
    created = int(fields[19]) / os.sysconf("SC_CLK_TCK")
    return time.clock_gettime(time.CLOCK_BOOTTIME) - created
