"""What the tests share: the programs (their folder is in TUBEBIN_PROGRAMS) and a small data set."""

from __future__ import annotations

import os
import pathlib
import subprocess
from typing import Callable

import pytest

SOURCE = pathlib.Path(os.environ.get("TUBEBIN_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
CONFIG = SOURCE / "config" / "set_a.yaml"

Run = Callable[..., str]


@pytest.fixture(scope="session")
def run() -> Run:
    """Runs one of the programs and returns what it prints."""
    folder = os.environ.get("TUBEBIN_PROGRAMS")
    if folder is None:
        pytest.skip("TUBEBIN_PROGRAMS does not name the folder of the programs to compare with")

    def run(program: str, *arguments: str | os.PathLike[str]) -> str:
        return subprocess.run([f"{folder}/{program}", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout

    return run


@pytest.fixture(scope="session")
def depth_dataset(run: Run, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Scenes A3/001 and A3/002, packed, of a scanner with noise, with depth images."""
    folder = tmp_path_factory.mktemp("data")
    config = folder / "config.yaml"
    noisy = CONFIG.with_name("scanner_zivid_like.yaml")
    config.write_text(f"include: {noisy}\noutput: {{depth_image: true, clean_cloud: false}}\n")
    run("generate_dataset", config, "--output", folder / "d", "--tubes", "3", "--cases", "2", "--pack", "--quiet")
    return folder / "d"


@pytest.fixture(scope="session")
def dataset(run: Run, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """Scenes A3/001, A3/002, A10/001 and A10/002 of seed 7."""
    folder = tmp_path_factory.mktemp("data") / "loose"
    run("generate_dataset", CONFIG, "--output", folder, "--tubes", "3,10", "--cases", "2", "--seed", "7", "--quiet")
    return folder
