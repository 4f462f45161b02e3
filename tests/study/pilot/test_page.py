"""Pages are read as a browser reads them."""

from __future__ import annotations

from coadapt.study.pilot.page import read_page


def test_forms_fields_and_sockets() -> None:
    page = read_page(
        '<h1>One &amp; two</h1><form action="/s/k" data-socket="/s/k/steer">'
        '<input type="hidden" name="stage" value="scale 1">'
        '<input type="hidden" name="csrf" value="x">'
        '<input type="radio" name="a" value="1"><input type="radio" name="a" value="2">'
        '<textarea name="b"></textarea><button name="c" value="yes"><button name="c" value="no">'
        '</form><form action="/s/k/withdraw"><input type="hidden" name="csrf" value="x"></form>'
    )
    assert page.heading == "One & two"
    assert page.socket == "/s/k/steer" and not page.steers
    assert page.form is not None and page.form.stage == "scale 1"
    assert page.form.hidden == {"stage": "scale 1", "csrf": "x"}
    assert page.form.choices == {"a": ["1", "2"]}
    assert page.form.texts == ["b"] and page.form.buttons == {"c": ["yes", "no"]}
    assert page.withdrawal is not None and page.withdrawal.action == "/s/k/withdraw"


def test_a_page_for_steering() -> None:
    page = read_page('<div id="steer" data-socket="/s/k/steer"></div>')
    assert page.steers and page.form is None
