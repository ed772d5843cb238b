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


def test_claims_are_listed_with_how_each_would_fail(run, tmp_path):
    listed = json.loads(run("reproduce", "--list", "--json").out)
    assert [each["id"] for each in listed] == list(EXPERIMENTS)
    fails = {each["id"]: each["fails"] for each in listed}
    assert fails["worst-pixel-error"] == "fails if a value lies outside 0.09365 to 0.09385"
    assert sum(text.startswith("cannot fail") for text in fails.values()) < len(fails) / 3
    outcome = run("reproduce", "--list")
    assert all(name in outcome.out for name in EXPERIMENTS)
    assert not list(tmp_path.iterdir())


def test_two_at_a_time_find_the_same(run, tmp_path):
    only = ("--only", "energy-by-degree", "worst-pixel-error", "lambert-decay")
    for jobs in (1, 2):
        assert run("reproduce", *only, "--jobs", jobs, "--out", str(jobs)).code == 0
    for name in ("results.json", "report.html"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()
    assert "fails if a value lies outside" in (tmp_path / "1" / "report.html").read_text()


def test_a_failing_claim_is_shown_failing(run, monkeypatch, tmp_path):
    monkeypatch.setitem(EXPERIMENTS, "worst-pixel-error", lambda: Measurement([0.5], "wrong"))
    outcome = run("reproduce", "--only", "worst-pixel-error", "--out", "r", "--json")
    assert outcome.code == 1
    assert json.loads(outcome.out)["results"][0]["holds"] is False
    assert "FAILS" in (tmp_path / "r" / "report.html").read_text()


def test_unknown_claims_are_refused(check_refused):
    check_refused("no claim is called 'nothing'; there are", "reproduce", "--only", "nothing")
    check_refused("jobs must be 1 or more", "reproduce", "--jobs", 0)
    check_refused("name claims after --only", "reproduce", "worst-pixel-error")
