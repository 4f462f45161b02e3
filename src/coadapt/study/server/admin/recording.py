"""An attempt for the researcher to look at again, as `replay.ts` draws it."""

from __future__ import annotations

import msgspec

from coadapt.formalism import SharedAutonomy
from coadapt.study.attempts import StoredAttempt
from coadapt.study.protocol import Study
from coadapt.study.server.messages import Scene
from coadapt.study.server.scene import scene_of
from coadapt.study.session.events import Belief


class RecordedStep(msgspec.Struct, frozen=True, kw_only=True):
    """A step; see `coadapt.study.session.events.Stepped`. ``time``: seconds since the beginning."""

    step: int
    state: int
    reached: int
    input: int | None
    time: float
    action: int | None
    planned: int | None
    matched: bool | None
    belief: Belief | None


class Recording(msgspec.Struct, frozen=True, kw_only=True):
    """An attempt.

    Attributes:
        scene: what to draw.
        start: the robot state in which it began.
        adaptability: the values of alpha.
        modes, actions: names.
        steps: the steps.
        goal: index of the goal reached, or None.
    """

    scene: Scene
    start: int
    adaptability: tuple[float, ...]
    modes: tuple[str, ...]
    actions: tuple[str, ...]
    steps: tuple[RecordedStep, ...]
    goal: int | None


def recording_of(
    study: Study, model: SharedAutonomy, attempt: StoredAttempt, *, unblinded: bool
) -> Recording:
    """The recording of ``attempt``.

    What the robot planned and believed tells the condition: it is left out unless ``unblinded``.
    """
    values = model.alpha.values
    return Recording(
        scene=scene_of(study, model, attempt.stage),
        start=attempt.began.start,
        adaptability=tuple(float(alpha.mean()) for alpha in values),
        modes=model.mode_names,
        actions=tuple(model.world.action_names),
        steps=tuple(
            RecordedStep(
                step=stepped.step,
                state=stepped.state,
                reached=stepped.reached,
                input=stepped.input,
                time=round(step.time - attempt.began_at, 3),
                action=stepped.action,
                planned=stepped.planned if unblinded else None,
                matched=stepped.matched if unblinded else None,
                belief=stepped.belief if unblinded else None,
            )
            for step in attempt.steps
            for stepped in (step.stepped,)
        ),
        goal=attempt.finished.goal if attempt.finished else None,
    )
