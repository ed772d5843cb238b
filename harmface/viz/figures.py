"""From a matplotlib figure to PNG bytes and files, without global state or a display."""

from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from harmface.errors import FileError
from harmface.io.atomic import atomic_write

DPI = 120


def figure_bytes(figure: Figure) -> bytes:
    """Return a figure as PNG."""
    buffer = BytesIO()
    # Without the version of matplotlib in it, the same figure gives the same bytes.
    figure.savefig(buffer, format="png", dpi=DPI, bbox_inches="tight", metadata={"Software": None})
    return buffer.getvalue()


def write_figure(path: Path | str, figure: Figure) -> None:
    """Write a figure as PNG, whole or not at all.

    Parameters
    ----------
    path
        The file to make or replace; it must end in `.png`.
    figure
        What to write.
    """
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise FileError(f"{path}: figures are written as PNG; give a name that ends in .png")
    with atomic_write(path) as file:
        file.write(figure_bytes(figure))
