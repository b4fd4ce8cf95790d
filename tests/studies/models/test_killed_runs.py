"""A run killed at any moment, without warning, goes on to the answer of a run that was left alone."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from studies.results.run_files import PATH_COLUMNS, read_path, read_summary

ROOT = Path(__file__).resolve().parents[3]
LEVELS = {"axisymmetric": ("axisymmetric-r1", "axisymmetric-r2", "axisymmetric-r4"), "full3d": ("full3d-n8",)}


@pytest.fixture(scope="module")
def scene(tmp_path_factory) -> Path:
    """One convolution, four pressures."""
    text = (ROOT / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
    text = text.replace("convolutions = 2", "convolutions = 1").replace("[5.0, 10.0]", "[5.0, 10.0, 15.0, 20.0]")
    path = tmp_path_factory.mktemp("killed") / "small.toml"
    path.write_text(text.replace("fields = true", "fields = false"), encoding="utf-8")
    return path


def wait_for(path: Path, process: subprocess.Popen) -> None:
    while not path.exists() and process.poll() is None:
        time.sleep(0.005)


def assert_same_runs(found: Path, expected: Path, model: str) -> None:
    for level in LEVELS[model]:
        a, b = read_path(found / level), read_path(expected / level)
        assert len(a) == len(b)
        for x, y in zip(a, b, strict=True):
            for name in PATH_COLUMNS:
                if name not in ("wall_s", "residual"):  # what Newton leaves of it is round-off
                    p, q = getattr(x, name), getattr(y, name)
                    # asked 1e-9; the steps are the same, so the same bits but for twelve digits in the file
                    assert p == q or p == pytest.approx(q, rel=1e-9, nan_ok=True), (level, name, p, q)
        assert read_summary(found / level).factorisations == read_summary(expected / level).factorisations


def kill_five_times(python, scene: Path, tmp_path: Path, model: str) -> None:
    def start(out: Path) -> subprocess.Popen:
        arguments = ("-m", "studies", "solve", scene, "--out", out, "--model", model)
        return python.start(1, *arguments, stdout=subprocess.DEVNULL)

    whole = tmp_path / "whole"
    process = start(whole)
    wait_for(whole / "scene.toml", process)
    begin = time.perf_counter()
    python.finish(process)
    duration = time.perf_counter() - begin

    rng = random.Random(5)
    out = tmp_path / "killed"
    killed = 0
    for _ in range(20):
        process = start(out)
        wait_for(out / "scene.toml", process)
        time.sleep(rng.uniform(0.05, 0.5) * duration)
        if process.poll() is not None:  # done before it could be killed: what else ran on the machine has ended
            shutil.rmtree(out)
            duration *= 0.7
            continue
        process.send_signal(signal.SIGKILL)
        process.communicate()
        killed += 1
        if killed == 5:
            break
    assert killed == 5
    python.finish(start(out))
    assert_same_runs(out, whole, model)


def test_axisymmetric_run_killed_five_times_gives_the_same_path(python, scene, tmp_path) -> None:
    kill_five_times(python, scene, tmp_path, "axisymmetric")


@pytest.mark.slow
def test_full_run_killed_five_times_gives_the_same_path(python, scene, tmp_path) -> None:
    kill_five_times(python, scene, tmp_path, "full3d")
