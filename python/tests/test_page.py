"""The Python blocks of docs/python.md run, in their order."""

from __future__ import annotations

import pathlib
import re

import pytest
from conftest import SOURCE


def test_the_page_runs(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "config").symlink_to(SOURCE / "config")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", (SOURCE / "docs" / "python.md").read_text(), re.DOTALL):
        exec(block, names)
    assert len(capsys.readouterr().out.splitlines()) == 13
