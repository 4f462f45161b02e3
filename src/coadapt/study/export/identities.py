"""Who the pseudonyms of an export are: a file of its own, never part of an export."""

from __future__ import annotations

import csv
import io
import os

from coadapt.momdp.files.atomic import replacing
from coadapt.study.record import Stored
from coadapt.study.session.events import Opened


def write_identities(stored: Stored, path: str | os.PathLike[str]) -> None:
    """Write the parameters of each participant's link beside their pseudonym, as CSV.

    Raises:
        FileError: if the file cannot be written.
    """
    names = stored.study.recruitment.parameters
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["participant", *names])
    for record in stored.records():
        opened = next(k.event for k in record.events if isinstance(k.event, Opened))
        table.writerow([record.alias, *(opened.parameters.get(name, "") for name in names)])
    with replacing(path) as file:
        file.write(text.getvalue().encode())
