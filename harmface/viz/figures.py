"""From a matplotlib figure to bytes and files, without global state or a display."""

from io import BytesIO
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure

from harmface import checks
from harmface.errors import FileError
from harmface.io.atomic import atomic_write

DPI = 120

FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
"""Formats of figures by the ending of a name."""

# What matplotlib writes of itself and of the time is left out: the same figure, the same bytes.
_UNDATED = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


class NotebookFigure(Figure):
    """A figure that notebooks show as it is, without pyplot or `%matplotlib inline`."""

    def _repr_png_(self) -> bytes:
        return figure_bytes(self)


def colour_bar(axes: Axes, shown: ScalarMappable, label: str) -> Colorbar:
    """Draw a colour bar beside a picture.

    Parameters
    ----------
    axes
        Where the picture is.
    shown
        The picture, as `imshow` returns it.
    label
        What the colours mean, with its unit.

    Returns
    -------
    matplotlib.colorbar.Colorbar
        The bar.
    """
    inset = axes.inset_axes((1.03, 0.0, 0.05, 1.0))
    bar = axes.figure.colorbar(shown, cax=inset)
    bar.ax.tick_params(labelsize=6, length=2)
    bar.set_label(label, fontsize=7)
    bar.outline.set_linewidth(0.4)
    return bar


def figure_bytes(figure: Figure, kind: str = "png", dpi: int | None = None) -> bytes:
    """Return a figure as PNG, SVG or PDF; the same figure gives the same bytes.

    Parameters
    ----------
    figure
        Any figure of matplotlib.
    kind
        "png", "svg" or "pdf".
    dpi
        Dots per inch, 120 if not given; in SVG and PDF of the pictures in it.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    ArgumentError
        If `dpi` is below 1.
    """
    dpi = DPI if dpi is None else checks.positive_integer("dpi", dpi)
    buffer = BytesIO()
    with mpl.rc_context({"svg.hashsalt": "harmface"}):
        figure.savefig(buffer, format=kind, dpi=dpi, bbox_inches="tight", metadata=_UNDATED[kind])
    return buffer.getvalue()


def write_figure(path: Path | str, figure: Figure, *, dpi: int | None = None) -> None:
    """Write a figure, whole or not at all.

    Parameters
    ----------
    path
        The file to make or replace; its ending, `.png`, `.svg` or `.pdf`, says the format.
    figure
        What to write.
    dpi
        Dots per inch, 120 if not given.

    Raises
    ------
    FileError
        If the name has another ending or the file cannot be written.
    """
    path = Path(path)
    kind = FORMATS.get(path.suffix.lower())
    if kind is None:
        raise FileError(
            f"{path}: figures are written as PNG, SVG or PDF; give a name that ends in "
            f"{', '.join(FORMATS)}"
        )
    data = figure_bytes(figure, kind, dpi)
    with atomic_write(path) as file:
        file.write(data)
