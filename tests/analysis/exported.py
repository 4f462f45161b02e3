"""A small study as `coadapt study export` writes it, to be damaged in any place."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

from coadapt.study.protocol.reader import template

CONDITIONS = ("no_adaptation", "mutual_adaptation", "one_way_adaptation")
TRUST = ("trust_right_thing", "trust_trustworthy")
COLLABORATION = tuple(
    f"collaboration_{name}"
    for name in ("satisfied", "goals", "together", "reasonable", "responsive")
)
EACH = 6
"""Participants of a condition."""

Tables = dict[str, list[dict[str, Any]]]


def tables() -> Tables:
    """Participants p01 to p18: six of each condition, their trials, steps and answers."""
    found: Tables = {"participants": [], "trials": [], "steps": [], "answers": []}
    for i in range(3 * EACH):
        name, condition = f"p{i + 1:02d}", CONDITIONS[i % 3]
        found["participants"].append(
            {
                "participant": name,
                "included": "true",
                "standing": "completed",
                "simulated": "false",
                "condition": condition,
                "checks_failed": 0,
            }
        )
        # All, some and few trials end at the optimal goal.
        optimal = (3, (i // 3) % 3 + 1, (i // 3) % 2)[i % 3]
        for trial in (1, 2, 3):
            at = trial <= optimal
            found["trials"].append(
                {
                    "participant": name,
                    "trial": trial,
                    "condition": condition,
                    "choice": "left",
                    "optimal": "right",
                    "finished": "true",
                    "goal": "right" if at else "left",
                    "at_optimal": str(at).lower(),
                    "reward": 11.0 if at else 10.0,
                    "steps": 3,
                    "changed": str(at and i % 3 == 1).lower(),
                    "inputs": 3,
                    "disagreements": int(i % 3 != 2),
                    "matched": 1,
                    "belief_alpha": "[0.25,0.25,0.5]" if i % 3 == 1 else "[0.5,0.25,0.25]",
                    "duration": 4.5,
                }
            )
            for step in range(3):
                towards = 0.2 + 0.3 * step * at
                moved = 0.1 * step * (i % 3 == 1)
                alphas = (0.5 - moved, 0.25, 0.25 + moved)
                belief = [[round(a * (1 - towards), 6), round(a * towards, 6)] for a in alphas]
                found["steps"].append(
                    {
                        "participant": name,
                        "stage": "trial",
                        "number": trial,
                        "attempt": 1,
                        "counts": "true",
                        "step": step,
                        "input": "left",
                        "action": "left" if step else "right",
                        "matched": str(step == 1).lower(),
                        "agreement": 0.75,
                        "belief": json.dumps(belief),
                    }
                )
        level = (2, 4, 4)[i % 3]
        for j, item in enumerate((*TRUST, *COLLABORATION)):
            value = min(5, max(1, level + (i // 3 + j) % 3 - 1))
            found["answers"].append(
                {
                    "participant": name,
                    "item": item,
                    "scale": "trust" if item in TRUST else "collaboration",
                    "kind": "rating",
                    "value": value,
                    "score": value,
                    "points": 5,
                }
            )
    return found


def export(
    folder: Path,
    change: Callable[[Tables], None] = lambda _: None,
    protocol: bytes | None = None,
) -> Path:
    """Write the study to ``folder``, after a change."""
    made = tables()
    change(made)
    (folder / "data").mkdir(parents=True)
    (folder / "materials").mkdir()
    for name, rows in made.items():
        with (folder / "data" / f"description-{name}_data.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
    text = template() if protocol is None else protocol
    (folder / "materials" / "study.toml").write_bytes(text)
    (folder / "materials" / "model.json").write_text(
        json.dumps({"goals": ["left", "right"], "adaptability": [0.0, 0.5, 1.0]})
    )
    stored = sha256(template()).hexdigest()
    (folder / "export.json").write_text(json.dumps({"format": 1, "protocol_sha256": stored}))
    return folder
