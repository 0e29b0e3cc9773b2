"""The command line of the benchmark."""

from gearidae.engine.integrate.driver import BLOCK_STEPS
from gearidae_bench import __main__ as program
from gearidae_bench import commands
from gearidae_bench.stress import run_stress


def test_an_interrupted_stress_run_keeps_what_is_done(tmp_path, monkeypatch, capsys):
    def interrupted(runs, seed, jobs, report):
        report(run_stress(1, seed, 1, BLOCK_STEPS))
        raise KeyboardInterrupt

    monkeypatch.setattr(commands, "run_stress", interrupted)
    monkeypatch.chdir(tmp_path)
    assert program.main(["--stress", "--runs", "8", "--jobs", "1", "-o", "out"]) == 130
    assert "1 of 8 scenes done" in capsys.readouterr().err
    assert "--runs 8 --seed 1` on" in (text := (tmp_path / "out" / "stress.md").read_text())
    assert "interrupted after 1 scenes" in text
