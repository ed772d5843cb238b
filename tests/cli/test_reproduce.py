import json

from harmface.reproduce.experiment import Measurement
from harmface.reproduce.registry import EXPERIMENTS


def test_claims_are_measured_and_reported(run, tmp_path):
    only = ("--only", "energy-by-degree", "worst-pixel-error", "--out", "report")
    outcome = run("reproduce", *only)
    assert outcome.code == 0
    assert "energy-by-degree" in outcome.out
    results = json.loads((tmp_path / "report" / "results.json").read_text())["results"]
    assert [result["id"] for result in results] == ["energy-by-degree", "worst-pixel-error"]
    assert all(result["holds"] for result in results)
    report = (tmp_path / "report" / "report.html").read_text()
    assert "0.09375" in report
    assert "data:image/png;base64," in report


def test_a_failing_claim_is_shown_failing(run, monkeypatch, tmp_path):
    monkeypatch.setitem(EXPERIMENTS, "worst-pixel-error", lambda: Measurement([0.5], "wrong"))
    outcome = run("reproduce", "--only", "worst-pixel-error", "--out", "r", "--json")
    assert outcome.code == 1
    assert json.loads(outcome.out)["results"][0]["holds"] is False
    assert "FAILS" in (tmp_path / "r" / "report.html").read_text()


def test_unknown_claims_are_refused(check_refused):
    check_refused("no claim is called 'nothing'; there are", "reproduce", "--only", "nothing")
    check_refused("name claims after --only", "reproduce", "worst-pixel-error")
