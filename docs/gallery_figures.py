"""The figures of gallery examples: they are made without pyplot, which sphinx-gallery expects."""

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

from harmface.viz import write_figure


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Write every figure that a block has made, and return the text that shows them."""
    names = block_vars["example_globals"]
    shown = names.setdefault("_shown", set())
    written = []
    for figure in [value for value in names.values() if isinstance(value, Figure)]:
        if id(figure) not in shown:
            shown.add(id(figure))
            path = next(block_vars["image_path_iterator"])
            write_figure(path, figure)
            written.append(path)
    return figure_rst([str(Path(path)) for path in written], gallery_conf["src_dir"])
