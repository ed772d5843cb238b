"""Speed of the viewer's page in a browser that draws in software, and of writing it.

Needs `'.[test]'` and Chromium.
"""

import shutil
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright
from rich.console import Console
from rich.table import Table

from data_synth.shapes import bumpy_sphere
from harmface.io import read_mesh, write_ply
from harmface.light import published_probe
from harmface.reproduce.synthetic import mesh_of
from harmface.viz import viewer

# Of the sphere: 40,000 and 200,000 vertices.
RESOLUTIONS = (141, 316)
SECONDS = 4
ARGUMENTS = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
WIDTH, HEIGHT = 1200, 800


def main() -> None:
    """Print seconds to write and to open, and frames a second, for meshes of several sizes."""
    program = shutil.which("chromium")
    if program is None:
        raise SystemExit("no browser: apt-get install chromium")
    table = Table("vertices", "read, s", "page, s", "MB", "open, s", "frames/s turning")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=program, args=list(ARGUMENTS), chromium_sandbox=False
        )
        for resolution in RESOLUTIONS:
            write_ply(Path(folder, "mesh.ply"), mesh_of(bumpy_sphere(resolution)))
            start = time.perf_counter()
            mesh = read_mesh(Path(folder, "mesh.ply"))
            read = time.perf_counter()
            page_file = Path(folder, "view.html")
            page = viewer(mesh, published_probe("grace"))
            page.write(page_file)
            written = time.perf_counter()
            opened, rate = _in_browser(browser, page_file)
            table.add_row(
                f"{len(mesh.vertices):,}",
                f"{read - start:.2f}",
                f"{written - read:.2f}",
                f"{len(page.html) / 1e6:.1f}",
                f"{opened:.1f}",
                f"{rate:.1f}",
            )
        browser.close()
    Console().print(table)


def _in_browser(browser: object, page_file: Path) -> tuple[float, float]:
    """Return the seconds until a page has drawn, and its frames a second while it turns."""
    page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})  # type: ignore[attr-defined]
    start = time.perf_counter()
    page.goto(page_file.as_uri())
    page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    opened = time.perf_counter() - start
    rate = page.evaluate(
        """(seconds) => new Promise((done) => {
            const start = performance.now();
            let frames = 0;
            const next = () => {
                const passed = (performance.now() - start) / 1000;
                if (passed > seconds) return done(frames / passed);
                frames += 1;
                turn(rotationAbout(1, 0.05), false);
                requestAnimationFrame(next);
            };
            next();
        })""",
        SECONDS,
    )
    page.close()
    return opened, rate


if __name__ == "__main__":
    main()
