"""Pages: what is in them, and that nothing else gets into them."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import InputError
from coadapt.study.order import shown_items
from coadapt.study.protocol import Item, Scale, Study
from coadapt.study.server import pages as pages_module
from coadapt.study.server.forms import Refusal
from coadapt.study.server.markdown import markdown
from coadapt.study.server.pages import NOTICES, Pages, Visit
from coadapt.study.server.scene import scene_of
from coadapt.study.session import Session, Stage, plan_of
from tests.study.server.pages_of import all_standings, asked_study, small_model, standing

VISIT = Visit(key="k" * 32, path="/s/" + "k" * 32, csrf="c0ffee")

VOID = {"meta", "link", "input", "br", "img", "hr"}


class Outline(HTMLParser):
    """Checks that elements are closed in their order, and collects what they are."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        """The attributes of all elements of one kind."""
        return [attributes for name, attributes in self.found if name == tag]

    @property
    def text(self) -> str:
        """All text, spaces put together."""
        return " ".join(" ".join(self.words).split())


def page(session: Session, study: Study | None = None, refusal: Refusal | None = None) -> Outline:
    html = Pages(study or asked_study(), small_model()).stage(session, VISIT, refusal)
    return Outline(html)


def test_every_page_stands_on_its_own() -> None:
    study = asked_study()
    made = Pages(study, small_model())
    htmls = [made.stage(session, VISIT) for session in all_standings()]
    htmls += [made.notice(name) for name in NOTICES]
    htmls.append(made.error("Not found", "There is *nothing* here."))
    for html in htmls:
        outline = Outline(html)
        assert len(outline.all("h1")) == 1
        assert len(outline.all("main")) == 1
        assert outline.all("html") == [{"lang": "en"}]
        # The policy of the pages allows no style and no program within them, and nothing of others.
        assert not outline.all("style")
        for attributes in (attributes for _, attributes in outline.found):
            assert not {name for name in attributes if name == "style" or name.startswith("on")}
            for name in ("href", "src", "action"):
                address = attributes.get(name)
                assert address is None or address.startswith(("/", "#"))
        for script in outline.all("script"):
            assert script.get("src") or script.get("type") == "application/json"
        identifiers = [a["id"] for _, a in outline.found if "id" in a]
        assert len(set(identifiers)) == len(identifiers)


def test_the_way_out_is_on_every_page_until_the_end() -> None:
    for session in all_standings():
        leave = f"{VISIT.path}/withdraw"
        forms = [form.get("action") for form in page(session).all("form")]
        assert (leave in forms) == (session.end is None)


def test_forms_carry_their_stage_and_their_token() -> None:
    for session in all_standings():
        outline = page(session)
        stage = f"{plan_of(asked_study())[session.position]}"
        fields = [(i.get("name"), i.get("value")) for i in outline.all("input")]
        posted = [form.get("action") for form in outline.all("form")]
        assert (("stage", stage) in fields) == (VISIT.path in posted)
        assert fields.count(("csrf", VISIT.csrf)) == len(posted)


def test_no_page_tells_the_condition() -> None:
    study = asked_study()
    names = {condition.name for condition in study.conditions}
    names |= {condition.robot for condition in study.conditions}
    made = Pages(study, small_model())
    for session in all_standings():
        html = made.stage(session, VISIT)
        assert not [name for name in names if name in html]


def test_what_was_given_is_shown_again_beside_the_problem() -> None:
    refusal = Refusal({"trust_trustworthy": "Please."}, {"trust_right_thing": "4"})
    outline = page(standing(Stage("scale")), refusal=refusal)
    checked = [i for i in outline.all("input") if "checked" in i]
    assert [(i["name"], i["value"]) for i in checked] == [("trust_right_thing", "4")]
    wrong = [f for f in outline.all("fieldset") if "wrong" in (f["class"] or "")]
    (described,) = [f["aria-describedby"] for f in wrong]
    assert described in [p.get("id") for p in outline.all("p")]
    assert "One answer is missing" in outline.text


def test_hostile_answers_are_shown_as_text() -> None:
    text = "</textarea><script>alert(1)</script>\"'"
    session = standing(Stage("questions"))
    outline = page(session, refusal=Refusal({"hand": "Please."}, {"comments": text}))
    assert text in outline.text
    assert all("src" in script for script in outline.all("script"))


def test_progress() -> None:
    outline = page(standing(Stage("trial", 2)))
    assert [li for li in outline.all("li") if li.get("aria-current") == "step"] == [
        {"class": "now", "aria-current": "step"}
    ]
    assert "Trial 2 of 3" in outline.text
    nothing = {"practice": 0, "scales": (), "questions": (), "hypotheses": ()}
    bare = msgspec.structs.replace(asked_study(), **nothing)
    assert "Questions End" not in page(standing(Stage("welcome"), bare), bare).text


def test_return_link() -> None:
    study = asked_study()
    recruitment = msgspec.structs.replace(study.recruitment, return_link="https://r.example/?c=1&d")
    linked = msgspec.structs.replace(study, recruitment=recruitment)
    links = [a["href"] for a in page(standing(Stage("debrief")), linked).all("a")]
    assert "https://r.example/?c=1&d" in links
    assert "You can close this page" in page(standing(Stage("debrief"))).text


@pytest.mark.parametrize("end", ["declined", "withdrawn", "excluded"])
def test_ends(end: str) -> None:
    outline = page(Session(opened=True, end=end))  # type: ignore[arg-type]
    assert not outline.all("form")


def test_programs_that_were_not_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages_module, "STATIC", tmp_path)
    (tmp_path / "pages.css").write_text("")
    (tmp_path / "icon.svg").write_text("")
    with pytest.raises(InputError, match=r"built/forms\.js has not been built.*`make`"):
        Pages(asked_study(), small_model())


def test_addresses_change_with_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages_module, "STATIC", tmp_path)
    (tmp_path / "a.css").write_text("1")
    first = pages_module.asset("a.css", "/root")
    (tmp_path / "a.css").write_text("2")
    assert re.fullmatch(r"/root/static/a\.css\?v=[0-9a-f]{12}", first)
    assert pages_module.asset("a.css", "/root") != first


def test_markdown() -> None:
    html = markdown("# A\n\nB **c** [d](https://e.example)\n\n###### F\n\n| a | b |\n|---|---|\n")
    assert "<h2>A</h2>" in html
    assert "<h6>F</h6>" in html
    assert "<strong>c</strong>" in html
    assert 'target="_blank" rel="noopener noreferrer"' in html
    assert "<table>" in html


@given(st.text())
def test_markdown_lets_no_html_through(text: str) -> None:
    allowed = {"p", "h2", "h3", "h4", "h5", "h6", "ul", "ol", "li", "em", "strong", "code", "pre"}
    allowed |= {"blockquote", "a", "img", "br", "hr", "table", "thead", "tbody", "tr", "th", "td"}
    html = markdown(f"{text}\n\n<script>alert(1)</script><p onclick=x>")
    assert "<script" not in html
    assert "<p onclick" not in html
    assert {tag for tag, _ in Outline(str(html)).found} <= allowed


def test_the_order_of_items() -> None:
    items = tuple(Item(name=f"i{n}", text="?") for n in range(8))
    scale = Scale(name="s", items=items, shuffle=True)
    orders = {shown_items(scale, f"key {k}") for k in range(200)}
    assert len(orders) > 190
    assert all(sorted(order, key=lambda i: i.name) == list(items) for order in orders)
    assert shown_items(scale, "key 1") == shown_items(scale, "key 1")
    firsts = [shown_items(scale, f"key {k}")[0].name for k in range(4000)]
    # 4000 draws from 8: a share of 500 has a standard deviation of 21.
    assert all(abs(firsts.count(item.name) - 500) < 5 * 21 for item in items)
    assert shown_items(msgspec.structs.replace(scale, shuffle=False), "key 1") == items


def test_the_scene() -> None:
    model = small_model()
    scene = scene_of(asked_study(), model, Stage("trial", 2))
    world = model.world
    assert (scene.kind, scene.number, scene.of) == ("trial", 2, 3)
    assert scene.positions == tuple(map(tuple, world.positions.tolist()))
    assert [goal.states for goal in scene.goals] == [goal.states for goal in world.goals]
    assert [i.name for i in scene.inputs] == list(model.interface.names)
    # All and only the moves of the world, in either direction, are drawn.
    moves = {
        frozenset((state, int(after)))
        for state in range(world.states)
        for after in world.moves[state]
        if after != state
    }
    assert {frozenset(pair) for pair in scene.free} == moves
    assert len(scene.free) == len(moves)
