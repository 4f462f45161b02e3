"""Writes docs/reference/equations.md: each equation of the paper beside the code that computes it.

Run it after a change of the list below or of a first line of a docstring that it quotes. A test
compares the page with what this writes, and looks for each equation in the docstrings it names.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

PAGE = Path(__file__).parent / "reference" / "equations.md"


@dataclass(frozen=True)
class Entry:
    """One equation or definition.

    Attributes:
        where: its number, or the section that defines it, as our docstrings cite it.
        what: what it is.
        formula: it in our notation, one line each.
        code: the names of what computes it, module and object separated by a colon.
    """

    where: str
    what: str
    formula: tuple[str, ...]
    code: tuple[str, ...]


ENTRIES = (
    Entry(
        "Sec. 2.1",
        "Adaptability and how it changes",
        ("alpha in [0, 1]", "T_alpha(alpha' | alpha): the identity in the paper"),
        ("coadapt.human.adaptation:Adaptability",),
    ),
    Entry(
        "Sec. 2.2",
        "The shared-autonomy world, which the robot alone moves",
        ("T: X_r x A_r -> X_r",),
        ("coadapt.worlds.world:World",),
    ),
    Entry(
        "Sec. 2.3",
        "The collaborative world, which both move",
        ("T: X_world x A_r x A_h -> X_world",),
        ("coadapt.worlds.joint:JointWorld", "coadapt.formalism.collaboration:Collaboration"),
    ),
    Entry(
        "Sec. 3.1",
        "Modal policies of maximum entropy",
        (
            "V(s) = log sum_a exp(-c + V(T(s, a))), V(goal) = 0",
            "m(s, a) = exp(-c + V(T(s, a)) - V(s))",
        ),
        ("coadapt.human.modal:maximum_entropy_policy", "coadapt.human.modal:soft_value"),
    ),
    Entry(
        "Eq. 1",
        "What the person remembers",
        ("h_k = x^{t-k+1}, a^{t-k+1}, ..., x^t, a^t",),
        ("coadapt.human.history:Windows",),
    ),
    Entry(
        "Eq. 2",
        "The robot mode that the person perceives",
        ("P(m_r | h_k) = eta m_r(x^{t-k+1}, a^{t-k+1}) ... m_r(x^t, a^t)",),
        ("coadapt.human.perceived:perceived_robot_mode",),
    ),
    Entry(
        "Eq. 3",
        "The person's change of mode",
        ("T_mh(m' | alpha, m) = sum_{m_r} P(m' | alpha, m, m_r) P(m_r | h_k)",),
        ("coadapt.human.adaptation:mode_transition",),
    ),
    Entry(
        "Eq. 4",
        "Switching to the robot's mode",
        ("P(m' | alpha, m, m_r) = alpha for m' = m_r, 1 - alpha for m' = m",),
        ("coadapt.human.adaptation:mode_transition",),
    ),
    Entry(
        "Eq. 5",
        "Inference of the person's mode from an input",
        ("b'(m') = eta O(a_h | m', x') sum_m T_mh(m' | alpha, m) b(m)",),
        (
            "coadapt.human.filter:correct",
            "coadapt.formalism.shared_autonomy:SharedAutonomy.correct",
        ),
    ),
    Entry(
        "Eq. 6",
        "The robot's reward",
        ("R = R_goal in a goal state, else R_other",),
        ("coadapt.formalism.reward:reward",),
    ),
    Entry(
        "Eq. 7",
        "The penalty where the robot is on its way",
        ("R_other = sum_{m_r} R_m(m_h, m_r) P(m_r | h_k)",),
        ("coadapt.formalism.reward:reward",),
    ),
    Entry(
        "Eq. 8",
        "The cost of disagreement",
        ("R_m(m_h, m_r) = 0 for m_r = m_h, else C",),
        ("coadapt.formalism.reward:reward", "coadapt.formalism.reward:disagreement"),
    ),
    Entry(
        "Eq. 9",
        "The belief update over adaptability and mode",
        (
            "b'(alpha', m') = eta O(a_h | m', x') sum_alpha sum_m T_x(x' | x, a_r)",
            "    T_alpha(alpha' | alpha) T_mh(m' | alpha, m) b(alpha, m)",
        ),
        (
            "coadapt.human.filter:predict",
            "coadapt.formalism.shared_autonomy:SharedAutonomy.predict",
        ),
    ),
    Entry(
        "Sec. 5.1",
        "The planning problem",
        ("{X, Y, A_r, T_x, T_alpha, T_mh, R, Omega, O}",),
        ("coadapt.formalism.shared_autonomy:SharedAutonomy.to_momdp",),
    ),
    Entry(
        "Sec. 5.3",
        "The match rule: execute the input once both are surely in the same mode",
        ("sum_m b(m) P(m_r = m | h_k) >= threshold",),
        ("coadapt.robots.match:MatchRule",),
    ),
    Entry(
        "Sec. 6.1",
        "The robots of the three conditions",
        (),
        (
            "coadapt.robots.mutual:MutualAdaptation",
            "coadapt.robots.one_way:OneWayAdaptation",
            "coadapt.robots.fixed:NoAdaptation",
        ),
    ),
    Entry(
        "Sec. 6.3",
        "The table-clearing task",
        (),
        ("coadapt.worlds.table_clearing:table_clearing",),
    ),
    Entry(
        "Sec. 7",
        "Histories by their features",
        ("h_k -> (x^t, f(h_k))",),
        ("coadapt.human.features:feature_windows",),
    ),
)


def find(name: str) -> object:
    """The object that ``module:name`` names."""
    module, _, path = name.partition(":")
    found: object = import_module(module)
    for part in path.split("."):
        found = getattr(found, part)
    return found


def page() -> str:
    """The page's text."""
    lines = [
        "# The paper's equations and the code",
        "",
        "Each equation and definition of the paper, in the notation of this package, with what",
        "computes it and the first line of its documentation. Written by `docs/make_equations.py`.",
        "",
    ]
    for entry in ENTRIES:
        lines += [f"## {entry.where}: {entry.what}", ""]
        if entry.formula:
            lines += ["```text", *entry.formula, "```", ""]
        for name in entry.code:
            module, _, path = name.partition(":")
            summary = (inspect.getdoc(find(name)) or "").partition("\n\n")[0].replace("\n", " ")
            place = f"src/{module.replace('.', '/')}.py"
            lines.append(f"- [`{path}`](../../{place}): {summary}")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
