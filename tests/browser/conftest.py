"""Pages in Debian's Chromium, drawn in software, as a user would handle them."""

import json
import os
import shutil
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = (
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--force-color-profile=srgb",
)


@pytest.fixture(scope="session")
def browser():
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip("no browser: apt-get install chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        # Chromium refuses its sandbox to root, as which containers run.
        started = driver.chromium.launch(
            executable_path=program, args=[*ARGUMENTS], chromium_sandbox=os.getuid() != 0
        )
        yield started
        started.close()


class Shown:
    """A page that is open, and what can be done to it and read from it."""

    def __init__(self, page):
        self.page = page
        self.complaints = []
        page.on("console", lambda message: self.complaints.append(message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("dialog", lambda dialog: self.complaints.append(f"dialog {dialog.message}"))
        page.on("request", self._requested)

    def _requested(self, request):
        if not request.url.startswith(("file:", "data:", "about:")):
            self.complaints.append(f"asked for {request.url}")

    def choose(self, name, value):
        self.page.select_option(f"#{name}", value)

    def press(self, key, times=1):
        self.page.focus("#view")
        for _ in range(times):
            self.page.keyboard.press(key)

    def settle(self):
        """Wait until nothing turns any more and everything asked for is drawn."""
        self.page.evaluate(
            """new Promise((done) => {
                const look = () => (soon ? setTimeout(look, 20)
                  : requestAnimationFrame(() => setTimeout(done)));
                look();
            })"""
        )

    def picture(self):
        """Return the canvas as the screen shows it, values in [0, 1]."""
        # The ring about what has the keyboard is no part of the picture.
        self.page.evaluate("scrollTo(0, 0); document.activeElement.blur()")
        self.settle()
        data = self.page.locator("#view").screenshot()
        return np.asarray(Image.open(BytesIO(data)).convert("RGB")) / 255

    def copied(self, kind):
        self.page.click(f"#copy{kind}")
        return self.page.inner_text("#readout")

    def state(self):
        return json.loads(self.copied("Json"))


@pytest.fixture
def show(browser, tmp_path):
    """Open pages from files, offline; in the end none may have complained."""
    opened = []

    def open_page(html, width=800, height=420):
        path = tmp_path / f"view{len(opened)}.html"
        path.write_text(html)
        context = browser.new_context(
            viewport={"width": width, "height": height}, offline=True, device_scale_factor=1
        )
        shown = Shown(context.new_page())
        opened.append((context, shown))
        shown.page.goto(path.as_uri())
        return shown

    yield open_page
    for context, shown in opened:
        context.close()
        assert shown.complaints == []
