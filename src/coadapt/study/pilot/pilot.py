"""A whole pilot: many simulated participants."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from urllib.parse import urlencode

import httpx2

from coadapt.formalism import SharedAutonomy
from coadapt.study.pilot.gate import Gate
from coadapt.study.pilot.person import Person, Population, people
from coadapt.study.pilot.walk import Ending, Failed, Walk
from coadapt.study.protocol import Study
from coadapt.study.session.plan import plan_of

WAVE = 17
"""Participants who take part at the same time."""

PATIENCE = 60.0
"""Seconds to wait for an answer of the server."""


@dataclass(frozen=True)
class Outcome:
    """What became of a simulated participant.

    Attributes:
        person: who it was.
        ending: how it ended.
        problem: what went wrong, if something did.
    """

    person: Person
    ending: Ending
    problem: str = ""


@dataclass(frozen=True)
class Piloted:
    """What became of all.

    Attributes:
        outcomes: in the order in which they came.
    """

    outcomes: Sequence[Outcome]

    @property
    def endings(self) -> dict[Ending, int]:
        """How many ended how."""
        return dict(Counter(outcome.ending for outcome in self.outcomes))

    @property
    def failures(self) -> list[Outcome]:
        """Those for whom something went wrong."""
        return [outcome for outcome in self.outcomes if outcome.ending == "failed"]


async def pilot(
    study: Study,
    model: SharedAutonomy,
    url: str,
    n: int,
    seed: int,
    population: Population | None = None,
    *,
    at_once: int = WAVE,
    progress: Callable[[str], None] = lambda _: None,
) -> Piloted:
    """Let ``n`` simulated participants take part.

    Args:
        study: its protocol.
        model: world, inputs and people of its task.
        url: where the server is, for example ``http://127.0.0.1:8000``.
        n: how many come.
        seed: of what they are like and do.
        population: where they are drawn from.
        at_once: how many take part at the same time.
        progress: is told what is being done.
    """
    persons = people(n, population or Population(), len(plan_of(study)), seed)
    outcomes: list[Outcome] = []
    for first in range(0, n, at_once):
        wave = persons[first : first + at_once]
        gate = Gate(len(wave))

        async def one(place: int, person: Person, gate: Gate = gate) -> Outcome:
            try:
                outcome = await _take_part(study, model, url, seed, person, gate, place)
            finally:
                gate.passed(place)
            progress(f"Participant {person.number} of {n}: {outcome.ending}")
            return outcome

        outcomes += await asyncio.gather(*(one(i, person) for i, person in enumerate(wave)))
    return Piloted(outcomes)


async def _take_part(
    study: Study,
    model: SharedAutonomy,
    url: str,
    seed: int,
    person: Person,
    gate: Gate,
    place: int,
) -> Outcome:
    link = f"/?{urlencode(_parameters(study, seed, person.number))}"
    async with httpx2.AsyncClient(base_url=url, timeout=PATIENCE) as client:
        try:
            ending = await Walk(person, study, model, client, link, gate, place).walk()
        except (Failed, httpx2.HTTPError, OSError) as error:
            return Outcome(person, "failed", f"{type(error).__name__}: {error}")
    return Outcome(person, ending)


def _parameters(study: Study, seed: int, number: int) -> dict[str, str]:
    """Of the link, as a recruitment service fills them in."""
    wanted = study.recruitment
    parameters = dict.fromkeys(wanted.parameters, "simulated")
    if wanted.participant is not None:
        parameters[wanted.participant] = f"simulated-{seed}-{number}"
    return {**parameters, "simulated": "1"}
