"""One at a time, in their order, whoever of them is cancelled."""

from __future__ import annotations

import asyncio

from coadapt.study.server.turnstile import Turnstile


def test_who_finds_it_open_goes_in_at_once() -> None:
    turnstile = Turnstile()
    assert turnstile.enter() and turnstile.is_taken
    assert not turnstile.enter()
    turnstile.leave()
    assert not turnstile.is_taken
    assert turnstile.enter()


def test_others_wait_in_their_order_and_nobody_gets_ahead_of_them() -> None:
    async def run() -> None:
        turnstile, seen = Turnstile(), list[int]()

        async def go(i: int) -> None:
            async with turnstile:
                seen.append(i)
                await asyncio.sleep(0)

        assert turnstile.enter()
        tasks = [asyncio.create_task(go(i)) for i in range(5)]
        await asyncio.sleep(0)
        assert seen == []
        turnstile.leave()
        assert not turnstile.enter()  # it is the first one's already
        await asyncio.gather(*tasks)
        assert seen == [0, 1, 2, 3, 4]
        assert not turnstile.is_taken

    asyncio.run(run())


def test_who_is_cancelled_does_not_stand_in_the_way() -> None:
    async def run() -> None:
        turnstile = Turnstile()

        async def go() -> str:
            async with turnstile:
                return "in"

        assert turnstile.enter()
        waiting, late, last = (asyncio.create_task(go()) for _ in range(3))
        await asyncio.sleep(0)
        waiting.cancel()
        await asyncio.sleep(0)
        turnstile.leave()  # lets `late` in, which is cancelled before it notices
        late.cancel()
        assert await last == "in"
        assert waiting.cancelled() and late.cancelled()
        assert not turnstile.is_taken

    asyncio.run(run())
