"""Clouds and data sets: views, files, packs."""

from __future__ import annotations

import pathlib
import pickle

import numpy as np
import pytest
from conftest import CONFIG, Run

import tubebin


@pytest.fixture(scope="module")
def cloud() -> tubebin.Cloud:
    return tubebin.generate({}, tubes=2).scan()


def test_arrays_are_views_of_an_image(cloud: tubebin.Cloud) -> None:
    height, width, _ = cloud.points.shape
    assert cloud.organized and cloud.points.dtype == np.float32 and height * width == len(cloud)
    assert cloud.labels is not None and cloud.labels.shape == (height, width) and cloud.labels.dtype == np.uint32
    assert np.shares_memory(cloud.points, cloud.points) and np.shares_memory(cloud.labels, cloud.labels)
    seen = np.isfinite(cloud.points).all(axis=2)
    assert set(np.unique(cloud.labels[seen])) == {0, 1, 2} and not cloud.labels[~seen].any()


def test_views_outlive_their_cloud_and_write_into_it(tmp_path: pathlib.Path) -> None:
    points = tubebin.Cloud(np.ones((2, 3, 3), np.float32)).points
    assert (points == 1).all()
    cloud = tubebin.Cloud(np.zeros((5, 3)), labels=np.arange(5))
    cloud.points[2] = 7
    tubebin.write_cloud(tmp_path / "cloud.ply", cloud)
    again = tubebin.read_cloud(tmp_path / "cloud.ply", scale=0.001)
    assert not again.organized and again.colors is None and again.labels is not None
    np.testing.assert_array_equal(again.points[:, 0], np.array([0, 0, 0.007, 0, 0], np.float32))
    np.testing.assert_array_equal(again.labels, np.arange(5))


@pytest.mark.parametrize("format", ["pcd_binary", "pcd_compressed", "pcd_ascii", "ply_binary"])
def test_every_format_reads_back(cloud: tubebin.Cloud, tmp_path: pathlib.Path, format: str) -> None:
    tubebin.write_cloud(tmp_path / "cloud", cloud, format=format)  # type: ignore[arg-type]
    again = tubebin.read_cloud(tmp_path / "cloud")
    np.testing.assert_array_equal(again.points, cloud.points)
    np.testing.assert_array_equal(again.labels, cloud.labels)
    np.testing.assert_array_equal(again.colors, cloud.colors)
    np.testing.assert_allclose(again.viewpoint, cloud.viewpoint, atol=1e-6)


def test_what_does_not_fit_is_named(cloud: tubebin.Cloud, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match=r"the last of 2 values; valid: \(H, W, 3\)"):
        tubebin.Cloud(np.zeros((5, 2)))
    with pytest.raises(ValueError, match="labels: 4 values; valid: one of each of the 5 points"):
        tubebin.Cloud(np.zeros((5, 3)), labels=np.zeros(4, np.uint32))
    with pytest.raises(ValueError, match="labels: one is -1; valid: whole numbers from 0"):
        tubebin.Cloud(np.zeros((2, 3)), labels=np.array([-1, 1]))
    with pytest.raises(ValueError, match="neither .pcd nor .ply"):
        tubebin.write_cloud(tmp_path / "cloud.xyz", cloud)
    with pytest.raises(OSError, match="nowhere.pcd"):
        tubebin.read_cloud("nowhere.pcd")


def test_a_dataset_is_read_by_number_and_name(dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path) -> None:
    arguments = ["--tubes", "3,10", "--cases", "2", "--seed", "7", "--pack", "--quiet"]
    run("generate_dataset", CONFIG, "--output", tmp_path / "packed", *arguments)
    loose, packed = tubebin.Dataset(dataset), tubebin.Dataset(tmp_path / "packed")
    assert loose.names == packed.names == ["A3/001", "A3/002", "A10/001", "A10/002"]
    assert len(loose) == 4 and [sample.name for sample in packed] == packed.names
    copy = pickle.loads(pickle.dumps(packed))
    for sample in [packed[-1], packed["A10/002"], copy[3], *reversed(packed)]:
        expected = loose[sample.name]
        np.testing.assert_array_equal(sample.cloud.points, expected.cloud.points)
        np.testing.assert_array_equal(sample.cloud.labels, expected.cloud.labels)
        assert sample.scene is not None and expected.scene is not None and sample.scene.json == expected.scene.json
    with pytest.raises(KeyError, match="has no scene A9/001"):
        loose["A9/001"]
    with pytest.raises(IndexError):
        loose[4]
    with pytest.raises(OSError):
        tubebin.Dataset(tmp_path / "nowhere")
