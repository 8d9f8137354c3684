"""The numbered examples run, and what they print is as good as their texts say."""

from __future__ import annotations

import pathlib
import re
import subprocess
import sys

import pytest
from conftest import SOURCE


def run_example(name: str, folder: pathlib.Path) -> str:
    script = SOURCE / "examples" / "python" / name
    return subprocess.run([sys.executable, script], check=True, cwd=folder, stdout=subprocess.PIPE, text=True).stdout


def test_generate_and_plot(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("matplotlib")
    assert len(run_example("1_generate_and_plot.py", tmp_path).splitlines()) == 10
    assert (tmp_path / "tubes.png").read_bytes().startswith(b"\x89PNG")


def test_model_a_scan(tmp_path: pathlib.Path) -> None:
    text = run_example("2_model_a_scan.py", tmp_path)
    tubes, radius = re.match(r"(\d+) tubes of radius (\S+) mm", text).groups()  # type: ignore[union-attr]
    assert int(tubes) == 6 and float(radius) == pytest.approx(12.5, abs=0.1)
    assert float(re.findall(r"micro-recall (\S+)", text)[0]) > 0.95


def test_score_your_own(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("sklearn")
    text = run_example("3_score_your_own.py", tmp_path)
    scores = [(float(a), float(b)) for a, b in re.findall(r"DBSCAN (\S+), tubebin (\S+)", text)]
    assert len(scores) == 3 and all(0.2 < theirs < ours and ours > 0.95 for theirs, ours in scores)


def test_view_in_open3d(tmp_path: pathlib.Path) -> None:
    open3d = pytest.importorskip("open3d")
    pytest.skip(f"Open3D {open3d.__version__} needs a window")
