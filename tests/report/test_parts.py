"""Small pieces of the report, each by itself."""

from __future__ import annotations

import pytest

from coadapt.report.figures.conditions import spread
from coadapt.report.html import fixed, inline_svg, percent, tiny
from coadapt.report.tables import Table


def test_numbers_are_written_for_people() -> None:
    assert fixed(-0.32, 2) == "−0.32"
    assert fixed(-0.0001, 2) == "0.00"
    assert percent(0.1234) == "12.3 %"
    assert tiny(0.0) == "0"
    assert tiny(5.55e-17) == "5.5 × 10⁻¹⁷" or tiny(5.55e-17) == "5.6 × 10⁻¹⁷"


def test_labels_are_spread_in_their_order() -> None:
    places = spread([1.0, 0.0, 1.05], least=0.5)
    assert places[1] < places[0] < places[2]
    assert places[2] - places[0] == pytest.approx(0.5)
    assert places[1] == 0.0
    assert spread([0.0, 1.0], least=0.5) == [0.0, 1.0]


def test_table_is_csv() -> None:
    table = Table("t", ("a", "b"), ((1, "x, y"), (None, True), (0.1, float("inf"))))
    assert table.csv() == 'a,b\n1,"x, y"\n,true\n0.1,inf\n'


def test_inline_figure_has_names_and_colours_of_the_page() -> None:
    document = (
        '<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="9pt" '
        'viewBox="0 0 9 9"><metadata>x</metadata><clipPath id="c"><rect width="3"/></clipPath>'
        '<path clip-path="url(#c)" style="fill: #0067a5"/></svg>'
    )
    assert inline_svg(document, "f") == (
        '<svg viewBox="0 0 9 9" aria-hidden="true" focusable="false">'
        '<clipPath id="f-c"><rect width="3"/></clipPath>'
        '<path clip-path="url(#f-c)" style="fill: var(--fig-mutual)"/></svg>'
    )
    with pytest.raises(ValueError, match="not an SVG"):
        inline_svg("<p/>", "f")
