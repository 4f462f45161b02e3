"""One decision: correct the belief, look up the plan, match, predict.

`decide` is the only code by which coadapt's robots decide: `decide_all` calls it for some
situations, `decide_one` for one, the compiled episodes for each of their steps. So all come to the
same to the bit.
"""

from __future__ import annotations

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.robots.kernels.belief import copy, correct, predict, predict_seen
from coadapt.robots.tables import ANSWERS, FIXED, FORESEES, RobotTables

NO_INPUT = -1
NO_ACTION = -1


@bare
def decide(
    r: RobotTables,
    window: int,
    human_input: int,
    belief: FloatArray,
    forecast: FloatArray,
    scratch: FloatArray,
) -> tuple[int, int, int, float, bool]:
    """Decide in ``window`` after ``human_input``.

    Args:
        r: the robot.
        window: what the person remembers.
        human_input: the input, or NO_INPUT.
        belief: ``[L, M]`` before the input; becomes the one after it.
        forecast: ``[L, M]`` is made the one before the next input.
        scratch: of `RobotTables.room` numbers.

    Returns:
        The planned action, what the input asks for, the action, the agreement, and whether the
        match rule made the difference, see `coadapt.robots.Decision`.
    """
    x = r.state[window]
    asked = NO_ACTION
    if human_input != NO_INPUT and r.rule != FORESEES:
        asked = int(r.asks[human_input])
    planned = NO_ACTION
    if r.rule == FIXED:
        planned = int(r.going[x])
    elif r.rule == FORESEES:
        planned = look_up(r, window, belief, scratch)
    if r.rule != FIXED and human_input != NO_INPUT:
        correct(r.likelihood[x, human_input], belief)
    if r.rule == ANSWERS:
        planned = look_up(r, window, belief, scratch)
    agreement = agree(belief, r.perceived[window, planned])
    matched = r.rule == ANSWERS and asked >= 0 and agreement >= r.threshold
    action = asked if matched else planned
    if r.rule == FIXED:
        copy(belief, forecast)
    elif r.mode_chance.shape[0] > 0:
        predict_seen(r, window, action, human_input, belief, forecast, scratch)
    else:
        predict(r, r.perceived[window, action], belief, forecast, scratch)
    return planned, asked, action, agreement, matched


@bare
def look_up(r: RobotTables, window: int, belief: FloatArray, scratch: FloatArray) -> int:
    """The action of the best vector, the first one on a tie."""
    rows, modes = belief.shape
    count = r.start[window + 1] - r.start[window]
    seen = r.mode_chance.shape[0] > 0
    hidden = rows if seen else rows * modes
    scratch[:count] = 0.0
    for y in range(hidden):
        mass = 0.0
        if seen:
            for m in range(modes):
                mass += belief[y, m]
        else:
            mass = belief[y // modes, y % modes]
        if mass == 0.0:
            continue
        first = r.start[window] * hidden + y * count
        for v in range(count):
            scratch[v] += mass * r.value[first + v]
    best = 0
    for v in range(1, count):
        if scratch[v] > scratch[best]:
            best = v
    return int(r.action[r.start[window] + best])


@bare
def agree(belief: FloatArray, perceived: FloatArray) -> float:
    """``sum_m b(m) P(m_r = m | window, a_r)``."""
    values, modes = belief.shape
    total = 0.0
    for m in range(modes):
        mass = 0.0
        for i in range(values):
            mass += belief[i, m]
        total += mass * perceived[m]
    return total


@kernel
def decide_all(
    r: RobotTables,
    windows: IntArray,
    human_inputs: IntArray,
    belief: FloatArray,
    forecast: FloatArray,
    planned: IntArray,
    asked: IntArray,
    action: IntArray,
    agreement: FloatArray,
    matched: BoolArray,
    scratch: FloatArray,
) -> None:
    """`decide` in ``N`` situations. ``belief`` ``[N, L, M]`` is corrected, the rest written."""
    for i in range(windows.shape[0]):
        planned[i], asked[i], action[i], agreement[i], matched[i] = decide(
            r, windows[i], human_inputs[i], belief[i], forecast[i], scratch
        )


@kernel
def decide_one(
    r: RobotTables,
    window: int,
    human_input: int,
    belief: FloatArray,
    forecast: FloatArray,
    scratch: FloatArray,
) -> tuple[int, int, int, float, bool]:
    """`decide`, for Python."""
    return decide(r, window, human_input, belief, forecast, scratch)


@kernel
def plan_all(
    r: RobotTables, windows: IntArray, belief: FloatArray, planned: IntArray, scratch: FloatArray
) -> None:
    """Write what is planned in ``N`` situations, before any input."""
    for i in range(windows.shape[0]):
        planned[i] = look_up(r, windows[i], belief[i], scratch)
