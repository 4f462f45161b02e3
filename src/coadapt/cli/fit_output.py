"""What `coadapt fit` prints and saves."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from coadapt.momdp.files.atomic import replacing

if TYPE_CHECKING:
    from coadapt.analysis.adaptability import Interval
    from coadapt.analysis.adaptability.fit import AdaptabilityFit

SHOWN = 40
"""Participants in the table; all are in the JSON object."""


def record(found: AdaptabilityFit) -> dict[str, object]:
    """For JSON."""
    ends = found.posterior.interval(found.level)
    people = [
        {
            "participant": name,
            "trials": int(found.recordings.trials[p]),
            "steps": int(found.recordings.steps[p]),
            "disagreements": float(found.modes.disagreements[p]),
            "alpha": float(found.posterior.mean[p]),
            "sd": float(found.posterior.sd[p]),
            "low": float(ends[p, 0]),
            "high": float(ends[p, 1]),
            "information_bits": float(found.posterior.information[p]),
            "log_evidence": float(found.posterior.log_evidence[p]),
        }
        for p, name in enumerate(found.recordings.names)
    ]
    return {
        "model": {
            "task": found.person.model.world.name,
            "memory": found.person.model.memory,
            "between_trials": "keep" if found.person.mode_lasts else "anew",
            "lapse": found.person.lapse,
        },
        "level": found.level,
        "prior": found.prior,
        "population": {
            "mean": _interval(found.mean),
            "sd": _interval(found.sd),
            "log_likelihood": found.population.log_likelihood,
        },
        "weights": {
            "values": list(found.weights.values),
            "weights": [_interval(weight) for weight in found.weights.weights],
            "mean": found.weights.mean,
            "sd": found.weights.sd,
            "log_likelihood": found.weights.log_likelihood,
        },
        "models": [_finite(asdict(model)) for model in found.models],
        "participants": people,
    }


def lines(found: AdaptabilityFit) -> Iterator[str]:
    """For people."""
    model, level = found.person.model, f"{100 * found.level:g} %"
    count = len(found.recordings)
    all_trials, all_steps = len(found.recordings.first_step) - 1, len(found.recordings.state)
    yield (
        f"{model.world.name}: {count:,} participant{'s' * (count != 1)}, {all_trials:,} trials, "
        f"{all_steps:,} steps; memory {model.memory}"
    )
    yield ""
    yield f"Population (beta distribution, {level} intervals)"
    for name, value in (("mean of alpha", found.mean), ("SD of alpha", found.sd)):
        yield f"  {name:<16}{value.estimate:6.3f}  {value.low:.3f} to {value.high:.3f}"
    yield f"Weights of single values (EM, {level} intervals)"
    for alpha, weight in zip(found.weights.values, found.weights.weights, strict=True):
        label = f"alpha = {alpha:g}"
        yield f"  {label:<16}{weight.estimate:6.3f}  {weight.low:.3f} to {weight.high:.3f}"
    yield ""
    yield "Models of people (log likelihoods in nats; evidence: differences are log Bayes factors)"
    yield "  model            k  parameters  log lik.       AIC       BIC  evidence  left out"
    for score in found.models:
        yield (
            f"  {score.name:<15}{score.memory:3}{score.parameters:12}{score.log_likelihood:10.2f}"
            f"{score.aic:10.2f}{score.bic:10.2f}{score.log_evidence:10.2f}{score.left_out:10.2f}"
        )
    yield ""
    yield f"Participants (posterior of alpha, {found.prior} prior, {level} credible intervals)"
    width = max(11, *(len(name) for name in found.recordings.names[:SHOWN]))
    yield f"  {'participant':<{width}}  trials  steps  apart  alpha  interval        bits"
    ends = found.posterior.interval(found.level)
    for p, name in enumerate(found.recordings.names[:SHOWN]):
        trials, steps = int(found.recordings.trials[p]), int(found.recordings.steps[p])
        yield (
            f"  {name:<{width}}{trials:8}{steps:7}"
            f"{found.modes.disagreements[p]:7.1f}{found.posterior.mean[p]:7.3f}"
            f"  {ends[p, 0]:.3f} to {ends[p, 1]:.3f}{found.posterior.information[p]:6.2f}"
        )
    if count > SHOWN:
        yield f"  ... and {count - SHOWN:,} more, all in --json"
    yield "  apart: expected steps in which they saw the robot in another mode than their own;"
    yield "  bits: what their inputs told of alpha"


def write_modes(path: Path, found: AdaptabilityFit) -> None:
    """Save the probability of each mode at every step, all or nothing."""
    recordings, model = found.recordings, found.person.model
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    names = [f"P({mode})" for mode in model.mode_names]
    rows.writerow(["participant", "trial", "step", "state", "input", "action", *names])
    for p, name in enumerate(recordings.names):
        first = int(recordings.first_trial[p])
        for trial in range(first, int(recordings.first_trial[p + 1])):
            begin = int(recordings.first_step[trial])
            for s in range(begin, int(recordings.first_step[trial + 1])):
                given = int(recordings.human_input[s])
                rows.writerow(
                    [
                        name,
                        trial - first + 1,
                        s - begin + 1,
                        model.world.state_names[recordings.state[s]],
                        "" if given < 0 else model.input_names[given],
                        model.world.action_names[recordings.action[s]],
                        *found.modes.probability[s].tolist(),
                    ]
                )
    with replacing(path) as file:
        file.write(text.getvalue().encode())


def _interval(value: Interval) -> dict[str, float]:
    return {"estimate": value.estimate, "low": value.low, "high": value.high}


def _finite(values: dict[str, object]) -> dict[str, object]:
    """JSON has no infinity: the likelihood of what is impossible is left out."""
    return {
        name: None if isinstance(value, float) and not isfinite(value) else value
        for name, value in values.items()
    }
