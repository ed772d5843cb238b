"""The report: one HTML file with its figures inside."""

from base64 import b64encode
from html import escape

from harmface.reproduce.claims import Claim
from harmface.reproduce.result import Result

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1c; max-width: 62rem;
       margin: 2.5rem auto; padding: 0 1.2rem; }
h1 { font-weight: 600; margin-bottom: 0; }
h2 { font-size: 1.1rem; margin: .6rem 0 .2rem; }
.sub { color: #666; margin-top: .2rem; }
table { border-collapse: collapse; width: 100%; margin: 1.5rem 0; font-size: .92em; }
th, td { text-align: left; vertical-align: top; padding: .45rem .7rem;
         border-bottom: 1px solid #ddd; }
td.n { font-variant-numeric: tabular-nums; }
.holds, .reached { color: #15722f; }
.FAILS { color: #b3161b; font-weight: 600; }
.not, .shown { color: #8a6100; }
section { border-top: 1px solid #ddd; padding: .6rem 0 1rem; }
figure { margin: 1rem 0; }
img { max-width: 100%; height: auto; }
figcaption { color: #555; font-size: .9em; }
"""


def render_report(results: list[Result], environment: dict[str, str]) -> str:
    """Return the report as HTML: a table of all claims, then each with its note and figures.

    Parameters
    ----------
    results
        What was measured.
    environment
        Versions and machine, by name.
    """
    failed = sum(result.failed for result in results)
    summary = f"{len(results)} claims measured, {failed or 'none'} failing."
    rows = "".join(_row(result) for result in results)
    details = "".join(_detail(result) for result in results)
    machine = ", ".join(f"{key} {value}" for key, value in environment.items())
    return (
        f"<!doctype html><html lang='en'><meta charset='utf-8'><title>harmface report</title>"
        f"<meta name='viewport' content='width=device-width'><style>{_STYLE}</style>"
        f"<h1>harmface against the papers</h1><p class='sub'>{summary} {escape(machine)}</p>"
        "<table><tr><th>Claim</th><th>Source</th><th>Published</th><th>Measured</th>"
        f"<th>Verdict</th></tr>{rows}</table>{details}</html>\n"
    )


def published(claim: Claim) -> str:
    """Return what was published, with how a measurement is held against it."""
    if isinstance(claim.expected, str):
        return claim.expected
    sign = {"at_most": "≤ ", "goal": "≤ ", "at_least": "≥ "}.get(claim.kind, "")
    bounds = numbers(claim.expected)
    if claim.kind == "equal":
        return f"{bounds} (± {numbers(claim.tolerance)})"
    return sign + bounds


def numbers(values: list[float]) -> str:
    """Return numbers to four significant digits, or six decimals where they are plain."""
    return ", ".join(
        f"{value:.7g}" if value == round(value, 6) else f"{value:.4g}" for value in values
    )


def _row(result: Result) -> str:
    claim = result.claim
    return (
        f"<tr><td><a href='#{claim.id}'>{claim.id}</a></td><td>{escape(claim.source)}</td>"
        f"<td class='n'>{escape(published(claim))}</td>"
        f"<td class='n'>{escape(numbers(result.values))}</td>"
        f"<td class='{result.verdict}'>{result.verdict}</td></tr>"
    )


def _detail(result: Result) -> str:
    figures = "".join(
        f"<figure><img alt='{escape(caption)}' src='data:image/png;base64,"
        f"{b64encode(picture).decode()}'><figcaption>{escape(caption)}</figcaption>"
        "</figure>"
        for caption, picture in result.pictures.items()
    )
    return (
        f"<section id='{result.claim.id}'><h2>{result.claim.id}</h2>"
        f"<p>{escape(result.claim.what)}.</p><p class='sub'>It {escape(result.claim.bound)}.</p>"
        f"<p>{escape(result.note)}</p>{figures}</section>"
    )
