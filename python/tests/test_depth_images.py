"""Depth images: the cloud's pixels, from files, from clouds and from scenes that were never written."""

from __future__ import annotations

import pathlib
import tarfile
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from conftest import SOURCE, Run

import tubebin


def points_of(image: tubebin.DepthImage) -> npt.NDArray[Any]:
    """(H, W, 3) in the world frame: each pixel's middle, at its depth."""
    rows, columns = np.indices(image.depth.shape) + 0.5
    rays = np.stack([columns, rows, np.ones_like(rows)], axis=-1) @ np.linalg.inv(image.intrinsics).T
    points: npt.NDArray[Any] = image.depth[..., None] * rays @ image.viewpoint[:3, :3].T + image.viewpoint[:3, 3]
    return points


def test_pixels_lead_back_to_the_clouds_points(depth_dataset: pathlib.Path) -> None:
    for sample in tubebin.Dataset(depth_dataset):
        image, cloud = sample.depth_image, sample.cloud
        assert cloud.labels is not None
        assert image.depth.dtype == np.float32 and image.labels.dtype == np.uint32
        seen = np.isfinite(cloud.points[..., 2])
        np.testing.assert_array_equal(image.depth > 0, seen)
        np.testing.assert_array_equal(image.labels, cloud.labels)
        np.testing.assert_array_equal(image.viewpoint, cloud.viewpoint)
        off = np.linalg.norm(points_of(image) - cloud.points, axis=2)[seen]
        assert off.max() < 0.06e-3  # half a unit of 0.1 mm, along rays up to 20 degrees off the axis


def test_files_clouds_and_scenes_give_the_same(depth_dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path) -> None:
    written = tubebin.Dataset(depth_dataset)["A3/002"].depth_image
    config = SOURCE / "config" / "scanner_zivid_like.yaml"
    run("generate_dataset", config, "--output", tmp_path / "d", "--tubes", "3", "--cases", "2", "--quiet")
    for image in [
        tubebin.Dataset(tmp_path / "d")["A3/002"].depth_image,
        tubebin.generate(config, tubes=3, seed=2022, case=2).depth_image(),
    ]:
        np.testing.assert_array_equal(image.depth, written.depth)
        np.testing.assert_array_equal(image.labels, written.labels)
        np.testing.assert_array_equal(image.intrinsics, written.intrinsics)


def test_arrays_outlive_their_image() -> None:
    depth = tubebin.generate({}, tubes=1).depth_image().depth
    assert depth.max() == 2  # the floor, metres


def test_images_are_read_without_the_cloud(depth_dataset: pathlib.Path, tmp_path: pathlib.Path) -> None:
    with tarfile.open(next((depth_dataset / "packs").glob("*.tar"))) as pack:
        pack.extractall(tmp_path)
    expected = tubebin.Dataset(depth_dataset)["A3/001"]
    scene = tmp_path / "loose/A3/001"
    scene.mkdir(parents=True)
    for name in ["depth.png", "labels.png", "scene.json"]:
        (tmp_path / f"A3/001.{name}").rename(scene / name)
    (scene / "cloud.pcd").write_text("no cloud")
    sample = tubebin.Dataset(tmp_path / "loose")["A3/001"]
    np.testing.assert_array_equal(sample.depth_image.depth, expected.depth_image.depth)
    with pytest.raises(tubebin.IoError, match=r"cloud\.pcd"):
        _ = sample.cloud
    (scene / "labels.png").write_bytes((scene / "labels.png").read_bytes()[:-30])
    with pytest.raises(tubebin.IoError, match=r"labels\.png: is damaged"):
        _ = tubebin.Dataset(tmp_path / "loose")["A3/001"].depth_image


def test_what_is_no_image_is_refused(tmp_path: pathlib.Path) -> None:
    scene = tubebin.generate(SOURCE / "config" / "two_scanners.yaml", tubes=1)
    with pytest.raises(tubebin.IoError, match="two1/001: has no depth image"):
        scene.depth_image()
    (tmp_path / "A1/001").mkdir(parents=True)
    tubebin.write_cloud(tmp_path / "A1/001/cloud.pcd", tubebin.Cloud(np.zeros((2, 3, 3)), labels=np.zeros((2, 3), int)))
    with pytest.raises(tubebin.IoError, match=r"has no scene\.json, and so no camera"):
        _ = tubebin.Dataset(tmp_path)["A1/001"].depth_image
