"""The Python blocks of docs/python.md run, in their order."""

from __future__ import annotations

import pathlib
import re
import subprocess
import sys

import pytest
from conftest import SOURCE


def run_blocks(uses_torch: bool) -> None:
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", (SOURCE / "docs" / "python.md").read_text(), re.DOTALL):
        if ("torch" in block) == uses_torch:
            exec(block, names)


@pytest.fixture(autouse=True)
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ["config", "data"]:
        (tmp_path / name).symlink_to(SOURCE / name)
    monkeypatch.chdir(tmp_path)


def test_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    run_blocks(uses_torch=False)
    assert len(capsys.readouterr().out.splitlines()) == 16


def test_what_needs_torch_runs(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("torch")
    run_blocks(uses_torch=True)
    words = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert words[:4] == ["A5/001", "A10/001", "A5/002", "A10/002"] and len(words) == 6


def test_only_who_asks_for_it_needs_torch() -> None:
    code = "import sys; sys.modules['torch'] = None; import tubebin; print('imported'); import tubebin.torch"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout == "imported\n"
    assert "ImportError: tubebin.torch needs PyTorch, which `pip install tubebin[torch]` brings" in result.stderr
