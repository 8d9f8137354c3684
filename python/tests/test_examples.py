"""The numbered examples run, and what they print is as good as their texts say."""

from __future__ import annotations

import pathlib
import re
import runpy
import subprocess
import sys
from typing import Any

import pytest
from conftest import SOURCE


def run_example(name: str, folder: pathlib.Path, *arguments: str) -> str:
    command = [sys.executable, str(SOURCE / "examples" / "python" / name), *arguments]
    return subprocess.run(command, check=True, cwd=folder, stdout=subprocess.PIPE, text=True).stdout


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


def test_train_on_depth_images_with_torch(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("torch")
    text = run_example("4_train_on_depth_images.py", tmp_path, "30")
    losses = [float(loss) for loss in re.findall(r"cross-entropy (\S+)", text)]
    assert len(losses) == 3 and losses[2] < 0.8 * losses[0]
    shares = [float(share) for share in re.findall(r"IoU (\S+)", text)]
    assert len(shares) == 3 and 0.7 < shares[0] <= 1


def test_view_in_open3d(monkeypatch: pytest.MonkeyPatch) -> None:
    open3d = pytest.importorskip("open3d")
    shown: list[Any] = []
    monkeypatch.setattr(open3d.visualization, "draw_geometries", shown.extend)  # without its window
    runpy.run_path(str(SOURCE / "examples" / "python" / "5_view_in_open3d.py"))
    assert len(shown) == 11 and len(shown[0].points) == len(shown[0].colors) > 10000
