"""Reads files with limited memory and prints what came of each: run as a program.

python limited.py BYTES FILE...
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

from coadapt.errors import InputError
from coadapt.momdp.files import read_policy, read_pomdp


def main() -> None:
    """One line of JSON for each file: name, and the message or null."""
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    limit = mapped + int(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    for name in sys.argv[2:]:
        read = read_pomdp if name.endswith((".pomdp", ".pomdpx")) else read_policy
        message = None
        try:
            read(name)
        except InputError as error:
            message = str(error)
        print(json.dumps([Path(name).name, message]), flush=True)


if __name__ == "__main__":
    main()
