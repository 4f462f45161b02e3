"""A participant goes from page to page."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Literal

import httpx2

from coadapt.formalism import SharedAutonomy
from coadapt.study.pilot.gate import Gate
from coadapt.study.pilot.page import Form, Page, read_page
from coadapt.study.pilot.person import Person
from coadapt.study.pilot.steer import Hand, Lost, latency
from coadapt.study.protocol import Study

Ending = Literal["finished", "vanished", "withdrawn", "declined", "turned away", "failed"]
"""``"turned away"``: the study was closed or full."""

TRIES = 20
"""Attempts at one training session or trial before a participant gives up."""


TOO_FAST = 429
"""Status of an answer that asks to come later."""


class Failed(Exception):
    """The server did something that a participant cannot deal with."""


@dataclass
class Walk:
    """One participant on their way.

    Args:
        person: who it is.
        study: knows what the questions are.
        model: how they see robot and world.
        client: their browser.
        link: with which they came.
        gate: the order of allocation.
        place: in that order, from 0.
    """

    person: Person
    study: Study
    model: SharedAutonomy
    client: httpx2.AsyncClient
    link: str
    gate: Gate
    place: int

    async def walk(self) -> Ending:
        """Go through the study.

        Raises:
            Failed: if the server answers otherwise than participants expect.
        """
        person, stages = self.person, 0
        hand = Hand(person, self.model)
        choice: int | None = None
        page = await self._get(self.link)
        while page.form is not None or page.steers:
            leaving = person.leaving if stages == person.leaves_at else None
            if leaving == "vanish":
                return "vanished"
            if leaving == "withdraw":
                return await self._withdraw(page)
            stages += 1
            if page.steers:
                goal = int(person.rng.integers(2)) if choice is None else choice
                page = await self._steer(page, hand, goal)
                continue
            form = page.form
            assert form is not None
            filled = await self._filled(form, page)
            if "goal" in filled:
                choice = int(filled["goal"])
                await self.gate.turn(self.place)
                page = await self._post(form, filled)
                self.gate.passed(self.place)
                await self.gate.all_passed()
            else:
                page = await self._post(form, filled)
            if filled.get("consent") == "no":
                return "declined"
        return "finished" if stages >= self._shortest else "turned away"

    @property
    def _shortest(self) -> int:
        """Fewest stages that a whole session has."""
        study = self.study
        return 5 + study.practice + study.trials + len(study.scales)

    async def _filled(self, form: Form, page: Page) -> dict[str, str]:
        """What the person puts into a form."""
        person = self.person
        filled = dict(form.hidden)
        if "latency" in filled:
            assert page.socket is not None
            took = await latency(self._socket(page.socket))
            pad = "Simulated pad" if person.device == "gamepad" else ""
            filled |= {"width": "1280", "height": "800", "latency": f"{took}", "pad": pad}
            filled |= {"browser": person.browser(), "device": person.device}
        elif "goal" in form.choices:
            filled["goal"] = form.choices["goal"][int(person.rng.integers(2))]
        elif "consent" in form.buttons:
            filled["consent"] = "no" if person.leaving == "decline" else "yes"
        else:
            filled |= person.answers(self.study, {*form.choices, *form.texts})
        return filled

    async def _steer(self, page: Page, hand: Hand, goal: int) -> Page:
        """Steer until the training session or trial has come to its end; the page after it."""
        person, population = self.person, self.person.population
        address, heading = self.address, page.heading
        refused = False
        for _ in range(TRIES):
            reloads, lost = (person.chance(p) for p in (population.reloads, population.disconnects))
            breaks_after = int(person.rng.integers(1, 8)) if reloads or lost else None
            assert page.socket is not None
            try:
                done = await hand.attempt(self._socket(page.socket), goal, breaks_after, lost=lost)
            except Lost as error:
                # The last step may have been on its way when the connection was lost: the page
                # that is there then offers to load it again.
                if refused:
                    raise Failed(f"steering ended: {error}") from error
                done, refused = False, True
            if done or reloads or refused:
                page = await self._get(address)
            if done or not page.steers or page.heading != heading:
                return page
        raise Failed(f"still steering after {TRIES} attempts")

    async def _withdraw(self, page: Page) -> Ending:
        form = page.withdrawal
        if form is None:
            raise Failed(f"found no way to withdraw on the page {page.heading!r}")
        await self._post(form, form.hidden)
        return "withdrawn"

    async def _get(self, address: str) -> Page:
        while True:
            answer = await self.client.get(address, follow_redirects=True)
            if answer.status_code != TOO_FAST:
                return self._read(answer)
            await asyncio.sleep(1.0)  # so many come at once that the server lets them wait

    async def _post(self, form: Form, filled: dict[str, str]) -> Page:
        answer = await self.client.post(form.action, data=filled, follow_redirects=True)
        return self._read(answer)

    def _read(self, answer: httpx2.Response) -> Page:
        page = read_page(answer.text)
        if answer.status_code != 200:
            raise Failed(f"the server answered {answer.status_code}: {page.heading}")
        self.address = answer.url.path
        return page

    def _socket(self, path: str) -> str:
        base = self.client.base_url
        scheme = "wss" if base.scheme == "https" else "ws"
        return f"{scheme}://{base.netloc.decode()}{path}"
