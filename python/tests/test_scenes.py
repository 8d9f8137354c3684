"""Generating and scanning: the bytes of generate_dataset."""

from __future__ import annotations

import json
import pathlib
import threading

import numpy as np
import pytest
from conftest import CONFIG, SOURCE, Run

import tubebin


def test_scene_and_cloud_are_those_of_the_program(dataset: pathlib.Path, tmp_path: pathlib.Path) -> None:
    for name, tubes, case in [("A3/001", 3, 1), ("A10/002", 10, 2)]:
        scene = tubebin.generate(CONFIG, tubes=tubes, seed=7, case=case)
        assert scene.id == name
        assert scene.json == (dataset / name / "scene.json").read_text()
        tubebin.write_cloud(tmp_path / "cloud.pcd", scene.scan())
        assert (tmp_path / "cloud.pcd").read_bytes() == (dataset / name / "cloud.pcd").read_bytes()


def test_a_scene_that_was_read_is_scanned_to_the_same_cloud(dataset: pathlib.Path, tmp_path: pathlib.Path) -> None:
    scene = tubebin.Dataset(dataset)["A3/002"].scene
    assert scene is not None
    tubebin.write_cloud(tmp_path / "cloud.pcd", scene.scan())
    assert (tmp_path / "cloud.pcd").read_bytes() == (dataset / "A3/002/cloud.pcd").read_bytes()


def test_a_scanner_with_noise_gives_the_same_bytes_each_time(run: Run, tmp_path: pathlib.Path) -> None:
    config = SOURCE / "config" / "scanner_zivid_like.yaml"
    run("generate_dataset", config, "--output", tmp_path / "d", "--tubes", "2", "--cases", "1", "--seed", "5", "--quiet")
    scene = tubebin.generate(config, tubes=2, seed=5)
    again = tubebin.Dataset(tmp_path / "d")[0].scene
    assert again is not None
    for k, cloud in enumerate([scene.scan(), scene.scan(), again.scan()]):
        tubebin.write_cloud(tmp_path / f"{k}.pcd", cloud)
        assert (tmp_path / f"{k}.pcd").read_bytes() == (tmp_path / "d/A2/001/cloud.pcd").read_bytes()


def test_several_scanners_make_one_cloud_with_sources() -> None:
    cloud = tubebin.generate(SOURCE / "config" / "two_scanners.yaml", tubes=1).scan()
    assert not cloud.organized and cloud.points.shape == (len(cloud), 3)
    assert cloud.sources is not None and set(np.unique(cloud.sources)) == {0, 1}


def test_a_dict_says_what_a_file_says(tmp_path: pathlib.Path) -> None:
    (tmp_path / "thin.yaml").write_text("tube: {radius: 0.008}\nbin: {length: 0.4}\n")
    config = {"tube": {"radius": np.float64(0.008)}, "bin": {"length": 0.4}}
    scene = tubebin.generate(config, tubes=2)
    assert scene.json == tubebin.generate(tmp_path / "thin.yaml", tubes=2).json
    assert json.loads(scene.json)["tubes"][0]["radius"] == 0.008


@pytest.mark.parametrize(
    ("config", "tubes", "message"),
    [
        ({"tube": {"radius": -1}}, 2, r"tube\.radius: '-1' is not valid; valid: 0\.0005 to 1 m"),
        ({"tube": {"radios": 1}}, 2, r"tube\.radios"),
        ({"tube": {"radius": {1}}}, 2, r"\{1\} is a set"),
        ({}, 0, r"tubes\[0\]: '0' is not valid"),
        ("missing.yaml", 2, r"missing\.yaml"),
    ],
)
def test_a_config_that_cannot_be_meant_is_named(config: tubebin.Config, tubes: int, message: str) -> None:
    with pytest.raises((tubebin.ConfigError, tubebin.IoError), match=message):
        tubebin.generate(config, tubes=tubes)


def test_a_scene_that_no_attempt_gives_is_an_error() -> None:
    with pytest.raises(tubebin.GenerationError, match="given up after 2 attempts"):
        tubebin.generate({"scanner": {"range_max": 0.2}, "attempts_max": 2}, tubes=1)


def test_threads_run_beside_each_other_and_make_what_one_makes() -> None:
    alone = [tubebin.generate({}, tubes=10, seed=seed).json for seed in range(4)]
    together = [""] * 4

    def generate(seed: int) -> None:
        together[seed] = tubebin.generate({}, tubes=10, seed=seed).json

    threads = [threading.Thread(target=generate, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    turns = 0  # of this thread, while the others are inside; with the lock held there would be about one a call
    while any(thread.is_alive() for thread in threads):
        threads[0].join(0.001)
        threads[-1].join(0.001)
        turns += 1
    assert together == alone
    assert turns > 10
