"""An analysis as JSON data, for scripts."""

from __future__ import annotations

import msgspec

from coadapt.analysis.analyse import FORMAT, Analysis


def to_json(analysis: Analysis) -> bytes:
    """Every number of an analysis as one JSON object; without the courses of trials."""
    data = analysis.data
    record = {
        "format": FORMAT,
        "source": data.source,
        "form": data.form,
        "sha256": data.sha256,
        "conditions": data.conditions,
        "notes": data.notes,
        "plan": analysis.plan,
        "flow": data.flow,
        "problems": data.problems,
        "deviations": analysis.deviations,
        "tested": analysis.tested,
        "exploratory": analysis.exploratory,
        "scales": analysis.scales,
        "summaries": analysis.summaries,
        "detectable_eta_squared": analysis.detectable,
        "participants": analysis.people,
        "trials": analysis.trials,
        "versions": analysis.versions,
    }
    return msgspec.json.format(msgspec.json.encode(record), indent=2) + b"\n"
