"""Paragraphs of the report that are made from the protocol: the method, and a checklist."""

from __future__ import annotations

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.tests import apa
from coadapt.hypotheses import HOLDS_FAMILY, Hypothesis
from coadapt.report.study.looks import title_of

TESTS = {
    "kruskal_wallis": "Kruskal-Wallis tests",
    "anova": "one-way analyses of variance",
    "welch": "Welch’s analyses of variance",
    "proportions": "tests of proportions",
    "mann_whitney": "two-sided Mann-Whitney tests",
    "tukey": "Tukey’s HSD",
    "games_howell": "Games and Howell’s test",
    "fisher": "Fisher’s exact test",
}

CORRECTIONS = {"bonferroni": "Bonferroni’s", "holm": "Holm’s", "none": "no"}


def method(found: Analysis) -> str:
    """A paragraph for the paper's section on the method."""
    data, declared = found.data, found.data.declared
    sizes = ", ".join(
        f"{title_of(name)} (n = {data.flow.analysed.get(name, 0)})" for name in data.conditions
    )
    left = sum(data.flow.left_out.values())
    parts = [
        f"{len(data.people)} {_who(found)} were analysed in {len(data.conditions)} conditions: "
        f"{sizes}.",
        f"Of {data.flow.opened} {'rows' if data.form == 'table' else 'sessions'} {left} were left "
        "out" + (f" ({_reasons(found)})." if left else ".")
        if data.form != "counts"
        else "The data are counts of participants.",
        f"Each participant did the task {declared.trials} times. Performance is the mean reward "
        f"over these trials, {declared.rewards.optimal:g} for the optimal goal and "
        f"{declared.rewards.other:g} for the other.",
    ]
    for scale in found.scales:
        shown = [apa.effect(e) for e in (scale.alpha, scale.spearman_brown) if e is not None]
        consistency = f" ({'; '.join(shown)})" if shown else ""
        parts.append(
            f"{title_of(scale.scale)} is the mean of {len(scale.items)} items{consistency}; "
            "a score was given where at least half of the items were answered."
        )
    parts += [_tests_of(hypothesis) for hypothesis in found.plan.hypotheses]
    parts.append(found.plan.text)
    used = ", ".join(f"{name} {number}" for name, number in found.versions.items())
    parts.append(f"Computed with {used}.")
    return " ".join(parts)


def _who(found: Analysis) -> str:
    simulated = found.data.flow.simulated
    if simulated == 0:
        return "participants"
    return (
        "simulated participants"
        if simulated == len(found.data.people)
        else "participants and programs"
    )


def _reasons(found: Analysis) -> str:
    return ", ".join(f"{count} {reason}" for reason, count in found.data.flow.left_out.items())


def _tests_of(hypothesis: Hypothesis) -> str:
    outcomes = " and ".join(title_of(name).lower() for name in hypothesis.outcomes)
    pairs = len(hypothesis.compared)
    text = f"{hypothesis.name} was tested on {outcomes} by {TESTS[hypothesis.test]}, "
    text += f"with pairs compared by {TESTS[hypothesis.pairs]}"
    if hypothesis.pairs in HOLDS_FAMILY:
        text += " over all pairs"
    elif hypothesis.correction == "none":
        text += f" without a correction for {pairs} comparisons"
    else:
        text += f" with {CORRECTIONS[hypothesis.correction]} correction for {pairs} comparisons"
    text += f", at a level of {hypothesis.level:g}."
    if hypothesis.equivalence is not None:
        text += (
            " Pairs without a significant difference were tested for equivalence within "
            f"±{hypothesis.equivalence:g} by two one-sided Welch tests."
        )
    return text


def checklist(found: Analysis) -> list[list[str]]:
    """What readers ask for: item, what these data say of it, what is left to write."""
    data, plan = found.data, found.plan
    left = _reasons(found) or "nobody left out"
    failed = sum(person.checks_failed > 0 for person in found.people)
    sizes = ", ".join(f"{title_of(n)} {c}" for n, c in data.flow.analysed.items())
    quotas = [f"{c.name} {c.quota}" for c in data.declared.conditions if c.quota is not None]
    detectable = "unknown" if found.detectable is None else apa.proportion(found.detectable)
    alphas = [
        f"{s.scale}: "
        + ("; ".join(apa.effect(e) for e in (s.alpha, s.spearman_brown) if e) or "none")
        for s in found.scales
    ]
    consent = "those without consent are left out" if data.form == "export" else "not in the data"
    hypotheses = ", ".join(h.name for h in plan.hypotheses) or "none"
    return [
        [
            "Hypotheses and tests set before data",
            f"{hypotheses}. {plan.text}",
            "where registered, if at all",
        ],
        ["Recruitment", f"{data.flow.opened} came", "where, when, how paid; who could take part"],
        [
            "People",
            "nothing in the data describes them",
            "age, gender, experience with robots",
        ],
        ["Consent and ethics", consent, "the board and its approval"],
        ["Allocation", f"analysed: {sizes}", "the method; who was blind to what"],
        ["Exclusions", left, "whether each rule was set before data"],
        [
            "Attention checks",
            f"{failed} failed at least one; nobody is excluded for it",
            "what was done",
        ],
        ["Bad data", f"{len(data.problems)} found, each listed with what was done", ""],
        [
            "Sample size and power",
            f"planned: {', '.join(quotas) or 'not said'}. With these groups an ANOVA at .05 finds "
            f"η² = {detectable} with a power of 80 %",
            "why this size; the smallest effect of interest",
        ],
        ["Scales", "; ".join(alphas) or "none", "their sources and whether they were changed"],
        ["Effect sizes with intervals", "in every test", ""],
        ["Assumptions", "looked at for every test, none chosen by them", ""],
        ["Several comparisons", "the number and the correction are in every sentence", ""],
        ["Simulated participants", f"{data.flow.simulated} of {len(data.people)}", ""],
        ["Open materials", f"data SHA-256 {data.sha256[:16]}…", "where data and protocol are"],
    ]
