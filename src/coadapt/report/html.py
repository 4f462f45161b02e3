"""The report as one HTML page that needs nothing else: figures and style are part of it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from coadapt import __version__
from coadapt.report.figures.style import TOKENS
from coadapt.report.identities import LIKELIHOOD, Identity
from coadapt.report.performance import RobotResult, distances
from coadapt.report.provenance import parameters
from coadapt.report.reproduce import Reproduction
from coadapt.report.samples import SampleRun


@dataclass(frozen=True)
class Grid:
    """A table as the page shows it.

    Attributes:
        caption: what it is.
        head: column titles.
        rows: cells as text; the first of a row is its title.
        text_columns: number of leading columns that hold text, not numbers.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    text_columns: int = 1


def render_html(found: Reproduction, svgs: Mapping[str, str], files: Sequence[str]) -> str:
    """The page.

    Args:
        found: all results.
        svgs: the figures ``sample_user_1``, ``sample_user_2``, ``performance``, ``conditions``
            and ``bounds`` as SVG documents.
        files: names of the files that lie beside the page.
    """
    world = found.settings.model.world
    best, other = world.goals[world.optimal_goal], world.goals[found.first_mode]
    policy, rule = found.robot("mutual_policy"), found.robot("mutual_rule")
    apart = max(distances(policy, other.reward, best.reward))
    return (
        environment()
        .get_template("report.html.j2")
        .render(
            version=__version__,
            found=found,
            settings=found.settings,
            model=found.settings.model,
            best=best,
            other=other,
            policy=policy,
            rule=rule,
            one_way=found.robot("one_way_rule"),
            none=found.robot("none"),
            apart=max(apart, *distances(rule, other.reward, best.reward)),
            figure={name: inline_svg(text, name) for name, text in svgs.items()},
            samples=[_sample(found, run) for run in found.samples],
            performance_tables=[_performance(robot) for robot in (policy, rule)],
            change_table=_changes(policy, rule),
            condition_tables=_conditions(found),
            identity_table=_identities(found.identities),
            root_table=_roots(found),
            parameter_table=_parameters(found),
            likelihood=LIKELIHOOD,
            files=files,
        )
    )


def environment() -> Environment:
    """The templates of all pages, with how they write numbers."""
    made = Environment(
        loader=PackageLoader("coadapt.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters.update(fixed=fixed, percent=percent, tiny=tiny)
    return made


def fixed(value: float, digits: int = 3) -> str:
    """A number with so many decimals and a real minus sign, never "-0.000"."""
    text = f"{value:.{digits}f}"
    return (text.lstrip("-") if float(text) == 0 else text).replace("-", "−")


def percent(value: float, digits: int = 1) -> str:
    """A probability in per cent."""
    return f"{fixed(100 * value, digits)} %"


def tiny(value: float) -> str:
    """A number of which the size matters, not the digits."""
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.1e}".split("e")
    powers = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return f"{mantissa} × 10{str(int(exponent)).translate(powers)}"


def inline_svg(document: str, name: str) -> Markup:
    """An SVG document as part of a page.

    Its identifiers get ``name`` in front, so that they are the page's only ones; its colours become
    variables of the page's style sheet; what only a file of its own needs is left out.
    """
    view = re.search(r'<svg [^>]*viewBox="([^"]+)"[^>]*>', document)
    if view is None:
        raise ValueError(f"figure {name} is not an SVG document with a viewBox")
    body = document[view.end() :]
    body = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", body, flags=re.S)
    text = f'<svg viewBox="{view[1]}" aria-hidden="true" focusable="false">{body}'
    text = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", text)
    text = re.sub(r'xlink:href="#([^"]+)"', rf'href="#{name}-\1"', text)
    for color, token in TOKENS.items():
        text = text.replace(color, f"var(--fig-{token})")
    return Markup(text)


def _sample(found: Reproduction, run: SampleRun) -> dict[str, object]:
    model, episode = found.settings.model, run.episode
    world, inputs = model.world, model.interface.names
    alphas = [f"b(α={value:g})" for value in model.alpha.values]
    modes = [f"b({name})" for name in model.mode_names]
    rows: list[list[str]] = []
    for t, (d, mode) in enumerate(zip(episode.decisions, episode.modes, strict=True), start=1):
        asked = "none" if d.human_input is None else inputs[d.human_input]
        beliefs = [*d.adaptability_belief, *d.mode_belief]
        rows.append(
            [
                f"{t}",
                world.state_names[d.state],
                model.mode_names[mode],
                asked,
                world.action_names[d.planned],
                world.action_names[d.action] + (" (matched)" if d.matched else ""),
                *(fixed(float(b)) for b in beliefs),
            ]
        )
    titles = ["T", "robot at", "user’s mode", "input", "planned", "action", *alphas, *modes]
    last = episode.decisions[-1].adaptability_belief
    return {
        "run": run,
        "figure": f"sample_user_{run.user}",
        "goal": "no goal" if episode.goal is None else f"the {world.goals[episode.goal].name} goal",
        "inputs": ", ".join("none" if i is None else inputs[i] for i in episode.inputs),
        "actions": ", ".join(world.action_names[a] for a in episode.actions),
        "likeliest": f"{model.alpha.values[int(last.argmax())]:g}",
        "likeliest_belief": float(last.max()),
        "replaced": sum(d.planned != d.action for d in episode.decisions),
        "table": Grid(f"User {run.user}, step by step", titles, rows, text_columns=6),
    }


def _performance(robot: RobotResult) -> Grid:
    rows = [
        [
            f"{alpha:g}",
            f"{fixed(e.reward, 4)} ± {_error(e.reward_error)}",
            fixed(s.reward.mean),
            fixed(s.reward.standard_error, 4),
            f"{fixed(s.low)} to {fixed(s.high)}",
            percent(p),
            percent(float(s.goals[robot.optimal_goal])),
        ]
        for alpha, e, p, s in zip(
            robot.alpha, robot.exact, robot.optimal, robot.simulated, strict=True
        )
    ]
    which = "with the match rule" if robot.match_rule else "the policy alone"
    head = ("α", "exact", "simulated", "standard error", "95 % interval")
    optimal = ("optimal goal, exact", "optimal goal, simulated")
    return Grid(f"Mean performance: {which}", (*head, *optimal), rows)


def _changes(policy: RobotResult, rule: RobotResult) -> Grid:
    measures = (
        ("reward of the goal", "reward"),
        ("robot actions", "steps"),
        ("inputs overridden", "overridden"),
        ("steps seen as disagreement", "disagreement"),
        ("discounted return", "discounted_return"),
    )
    rows = [
        [
            name,
            *(
                f"{fixed(getattr(a, key), 2)} → {fixed(getattr(b, key), 2)}"
                for a, b in zip(policy.exact, rule.exact, strict=True)
            ),
        ]
        for name, key in measures
    ]
    head = ("per episode", *(f"α = {alpha:g}" for alpha in policy.alpha))
    return Grid("What the match rule changes: without → with", head, rows)


def _conditions(found: Reproduction) -> list[Grid]:
    order = ("none", "mutual_rule", "one_way_rule", "mutual_policy", "one_way_policy")
    robots = [found.robot(key) for key in order]
    head = ("robot", *(f"α = {alpha:g}" for alpha in robots[0].alpha))
    measures = (
        ("Reward of the goal reached", [[fixed(e.reward) for e in r.exact] for r in robots]),
        ("Optimal goal reached", [[percent(p) for p in r.optimal] for r in robots]),
        ("Robot actions until a goal", [[fixed(e.steps, 2) for e in r.exact] for r in robots]),
        (
            "Expected number of steps in which the user sees the robot in another mode",
            [[fixed(e.disagreement, 2) for e in r.exact] for r in robots],
        ),
        (
            "Expected number of inputs overridden",
            [[fixed(e.overridden, 2) for e in r.exact] for r in robots],
        ),
    )
    return [
        Grid(caption, head, [[r.label, *row] for r, row in zip(robots, values, strict=True)])
        for caption, values in measures
    ]


def _identities(identities: Sequence[Identity]) -> Grid:
    rows = [
        [
            i.robot,
            i.planner,
            "holds" if i.holds else "does not hold",
            f"{i.decisions:,}" + ("" if i.complete else "*"),
            f"{i.differing:,}",
            f"{i.ties:,}",
            tiny(i.largest_loss),
            "–" if i.optimal_goal is None else fixed(i.optimal_goal, 9),
        ]
        for i in identities
    ]
    head = ("robot", "compared with", "identity", "decisions", "differ", "of these ties")
    return Grid(
        "The identities by numbers",
        (*head, "largest value loss", "P(optimal goal)"),
        rows,
        text_columns=3,
    )


def _roots(found: Reproduction) -> Grid:
    rows: list[list[str]] = []
    for name, p in (("Mutual adaptation", found.mutual), ("One-way adaptation", found.one_way)):
        for label, probability, low, high in zip(
            p.root_names, p.root_probability, p.root_lower, p.root_upper, strict=True
        ):
            rows.append([name, label, percent(probability), fixed(low, 5), fixed(high, 5)])
        rows.append([name, "weighted", "100 %", fixed(p.lower, 5), fixed(p.upper, 5)])
    head = ("planning model", "first input", "probability", "lower bound", "upper bound")
    return Grid("Bounds of the expected discounted return", head, rows, text_columns=2)


def _parameters(found: Reproduction) -> Grid:
    rows = [
        [p.name, p.value, "the paper" if p.origin == "paper" else "ours", p.source]
        for p in parameters(found)
    ]
    head = ("parameter", "value", "chosen by", "where, or why")
    return Grid("Every parameter and who chose it", head, rows, text_columns=4)


def _error(value: float) -> str:
    """A bound with as many decimals as what it bounds, rounded up."""
    return fixed(max(ceil(1e4 * value), 1) / 1e4, 4)
