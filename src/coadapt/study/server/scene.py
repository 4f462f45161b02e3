"""What the arena draws, from the model of a study's task."""

from __future__ import annotations

from coadapt.formalism import SharedAutonomy
from coadapt.human.history import NO_STATE
from coadapt.study.protocol import Study
from coadapt.study.server.messages import Goal, Scene, Steering
from coadapt.study.session.plan import Stage


def steering(model: SharedAutonomy) -> tuple[Steering, ...]:
    """The inputs of ``model``, in the order of their indices."""
    inputs = model.interface
    return tuple(
        Steering(name, (float(right), float(ahead)))
        for name, (right, ahead) in zip(inputs.names, inputs.directions.tolist(), strict=True)
    )


def scene_of(study: Study, model: SharedAutonomy, stage: Stage) -> Scene:
    """The scene of a training session or trial."""
    world = model.world
    pairs = {
        (min(state, after), max(state, after))
        for state, reached in enumerate(world.outcomes.reshape(world.states, -1).tolist())
        for after in reached
        if after not in (NO_STATE, state)
    }
    return Scene(
        kind="practice" if stage.kind == "practice" else "trial",
        number=stage.number,
        of=study.practice if stage.kind == "practice" else study.trials,
        positions=tuple((float(right), float(ahead)) for right, ahead in world.positions.tolist()),
        free=tuple(sorted(pairs)),
        goals=tuple(Goal(goal.name, goal.states) for goal in world.goals),
        inputs=steering(model),
        turns=study.clock.turns,
        step=study.clock.step,
    )
