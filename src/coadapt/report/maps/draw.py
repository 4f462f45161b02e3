"""The figures of a sweep: checked before it runs, drawn when it is finished."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from coadapt.momdp.files.atomic import replacing
from coadapt.report.maps import points
from coadapt.report.maps.mark import Mark, mark_of
from coadapt.simulation.sweep import Layout
from coadapt.simulation.sweep.table import Table

KINDS = ("svg", "png")


@dataclass(frozen=True)
class Figures:
    """What is to be drawn of a sweep.

    Attributes:
        phases: the map with people who never adapt, or None.
        outcomes: maps with people who do.
        trade_off: the trade-off curve, or None.
        mark: the setting to be marked.
    """

    phases: points.Map | None
    outcomes: tuple[points.Map, ...]
    trade_off: points.TradeOff | None
    mark: Mark | None

    @property
    def any(self) -> bool:
        """Whether there is something to draw."""
        return self.phases is not None or self.trade_off is not None


def figures_of(layout: Layout, directory: Path | None = None) -> Figures:
    """The figures that the grids of a sweep ask for.

    Args:
        layout: the sweep.
        directory: where files of tasks are looked for.

    Raises:
        InputError: if the cells of a figure are not what it needs.
    """
    of_phases, of_outcomes = layout.of_figure("phases"), layout.of_figure("outcomes")
    of_trade_off = layout.of_figure("trade_off")
    return Figures(
        phases=points.phases(of_phases) if of_phases else None,
        outcomes=tuple(points.outcomes(of_outcomes)) if of_phases else (),
        trade_off=points.trade_off(of_trade_off) if of_trade_off else None,
        mark=mark_of(layout.sweep, directory),
    )


def draw(figures: Figures, table: Table, directory: Path) -> list[Path]:
    """Draw ``figures`` into ``directory``, as SVG and PNG.

    Returns:
        The files written.

    Raises:
        FileError: if one cannot be written.
    """
    # Imported now: matplotlib is heavy.
    from coadapt.report.figures import style  # noqa: PLC0415
    from coadapt.report.maps.phase_map import phase_map  # noqa: PLC0415
    from coadapt.report.maps.trade_off import trade_off  # noqa: PLC0415

    rows = {str(row["cell"]): row for row in table.rows() if row["trial"] in (None, 1)}
    written: list[Path] = []
    with style.settings():
        drawn = {
            "phase_map": figures.phases
            and phase_map(figures.phases, figures.outcomes, rows, figures.mark),
            "trade_off": figures.trade_off and trade_off(figures.trade_off, rows, figures.mark),
        }
        for name, figure in drawn.items():
            for kind in KINDS if figure is not None else ():
                path = directory / f"{name}.{kind}"
                with replacing(path) as file:
                    file.write(style.render(figure, kind))  # pyright: ignore[reportArgumentType]
                written.append(path)
    return written
