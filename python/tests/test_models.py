"""Modelling and scoring: the results of model_tubes and evaluate."""

from __future__ import annotations

import json
import pathlib
import shutil
from typing import Any

import numpy as np
import pytest
from conftest import Run

import tubebin


def run_program(run: Run, cloud: pathlib.Path, output: pathlib.Path, *arguments: str) -> dict[str, Any]:
    """Of the cloud alone, without what scene.json beside it tells of the bin; returns model.json without times."""
    shutil.copy(cloud, output.parent / "alone.pcd")
    run("model_tubes", output.parent / "alone.pcd", "--output", output, "--quiet", *arguments)
    model: dict[str, Any] = json.loads((output / "model.json").read_text())
    del model["seconds"]
    return model


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        ([], {}),
        (["--radius", "0.0125", "--ratio", "0.3"], {"radius": 0.0125, "ratio": 0.3}),
        (["--radius", "0.0125,0.008", "--tube-length", "0.5"], {"radius": [0.0125, 0.008], "tube_length": 0.5}),
        (["--method", "region_growing", "--seed", "3"], {"method": "region_growing", "config": {"seed": 3}}),
    ],
)
def test_model_is_that_of_the_program(
    dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path, arguments: list[str], options: dict[str, Any]
) -> None:
    expected = run_program(run, dataset / "A10/001/cloud.pcd", tmp_path / "out", *arguments)
    cloud = tubebin.read_cloud(dataset / "A10/001/cloud.pcd")
    model = tubebin.model(cloud.points, cloud.viewpoint, **options)
    assert json.loads(model.json) == expected
    np.testing.assert_array_equal(model.labels, tubebin.read_cloud(tmp_path / "out/full.pcd").labels)


def test_a_told_bin_is_what_scene_json_tells_the_program(
    dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path
) -> None:
    run("model_tubes", dataset / "A10/002/cloud.pcd", "--output", tmp_path, "--quiet")
    sample = tubebin.Dataset(dataset)["A10/002"]
    assert sample.scene is not None
    size = json.loads(sample.scene.json)["bin"]
    config = {"bin_source": "config", "bin": {k: size[k] for k in ["length", "width", "height", "wall_thickness"]}}
    model = tubebin.model(sample.cloud.points, sample.cloud.viewpoint, config=config)
    np.testing.assert_array_equal(model.labels, tubebin.read_cloud(tmp_path / "full.pcd").labels)


def test_tubes_are_those_of_the_json(dataset: pathlib.Path) -> None:
    cloud = tubebin.Dataset(dataset)["A10/001"].cloud
    model = tubebin.model(cloud.points, cloud.viewpoint[:3, 3])
    written = json.loads(model.json)
    assert len(model.tubes) == len(written["tubes"]) and model.warnings == written["scene"]["doubts"]
    assert model.radius == pytest.approx(written["radius"], abs=1e-6)
    for tube, expected in zip(model.tubes, written["tubes"]):
        assert tube.label == expected["label"] and tube.branches == []
        assert tube.radius == pytest.approx(expected["radius"], abs=1e-6)
        assert tube.length == pytest.approx(expected["length"], abs=1e-5)
        assert tube.confidence == pytest.approx(expected["log_odds"], abs=0.1, rel=1e-3)
        assert tube.whole_log_odds == pytest.approx(expected["whole_log_odds"], abs=0.1)
        bridges = [cylinder["log_odds"] for cylinder in expected["cylinders"] if cylinder["bridged"]]
        assert tube.bridge_log_odds == pytest.approx(bridges, abs=0.1)
        assert tube.bridged == [cylinder["bridged"] for cylinder in expected["cylinders"]]
        nodes = [c["start"] for c in expected["cylinders"]] + [expected["cylinders"][-1]["end"]]
        np.testing.assert_allclose(tube.centerline, nodes, atol=1e-6)


def test_points_may_be_a_list_in_any_type(dataset: pathlib.Path) -> None:
    cloud = tubebin.Dataset(dataset)["A3/001"].cloud
    dense = cloud.points[np.isfinite(cloud.points).all(axis=2)].astype(np.float64)
    model = tubebin.model(dense, cloud.viewpoint)
    assert model.labels.shape == dense.shape[:1] and len(model.tubes) == 3


def test_doubts_are_warnings(dataset: pathlib.Path) -> None:
    cloud = tubebin.Dataset(dataset)["A10/001"].cloud
    in_another_unit = 30 * cloud.points
    with pytest.warns(tubebin.ModelWarning, match="radius") as caught:
        model = tubebin.model(in_another_unit, 30 * cloud.viewpoint[:3, 3])
    assert [str(warning.message) for warning in caught] == model.warnings
    assert {pathlib.Path(warning.filename).name for warning in caught} == {"test_models.py"}


def test_what_cannot_be_modelled_is_named() -> None:
    with pytest.raises(ValueError, match="radius: '-1.0' is not valid"):
        tubebin.model(np.zeros((5, 3)), np.zeros(3), radius=-1)
    with pytest.raises(OSError, match="has no finite point"):
        tubebin.model(np.full((5, 3), np.nan), np.zeros(3))
    with pytest.raises(ValueError, match="viewpoint: has 2 values"):
        tubebin.model(np.zeros((5, 3)), np.zeros(2))
    with pytest.raises(ValueError, match="viewpoint: is no position or rigid pose"):
        tubebin.model(np.zeros((5, 3)), 2 * np.eye(4))


def labels_with_errors(cloud: tubebin.Cloud) -> np.ndarray[Any, np.dtype[np.uint32]]:
    """Tubes 1 and 2 as one, tube 3 in halves, a part of tube 4 and of the bin wrong, under other numbers."""
    assert cloud.labels is not None
    labels = cloud.labels * 7
    labels[cloud.labels == 2] = 7
    half = (cloud.labels == 3) & (np.arange(cloud.labels.shape[1]) % 2 == 0)
    labels[half] = 1000
    labels[(cloud.labels == 4) & (np.arange(cloud.labels.shape[1]) % 3 == 0)] = 0
    labels[(cloud.labels == 0) & (np.arange(cloud.labels.shape[1]) % 5 == 0)] = 35
    labels[~np.isfinite(cloud.points).all(axis=2)] = 0
    return labels


def test_scores_are_those_of_the_program(dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path) -> None:
    cloud = tubebin.read_cloud(dataset / "A10/001/cloud.pcd")
    assert cloud.labels is not None
    seen = np.isfinite(cloud.points).all(axis=2)
    labels = labels_with_errors(cloud)
    tubebin.write_cloud(tmp_path / "labeled.pcd", tubebin.Cloud(cloud.points, labels=labels))
    clouds = ["--filtered", dataset / "A10/001/cloud.pcd", "--labeled", tmp_path / "labeled.pcd"]
    expected = json.loads(run("evaluate", *clouds, "--format", "json"))
    scores = tubebin.evaluate(cloud.labels[seen], labels[seen], bin_points="counted")
    assert (scores.correct, scores.total) == (expected["correct"], expected["points"])
    assert scores.micro_recall == pytest.approx(expected["micro_recall"], abs=1e-9)
    of_tubes = {row["ground truth"]: row for row in expected["matching"]}
    assert [str(tube.truth) for tube in scores.tubes] == sorted(of_tubes.keys() - {"0 (bin)"}, key=int)
    for tube in scores.tubes:
        row = of_tubes[str(tube.truth)]
        assert (tube.points, tube.correct) == (row["points"], row["correct"])
        assert str(tube.label).lower() == row["label"]
        assert tube.correct + tube.split + tube.merged + tube.missed == tube.points
        for measure, value in [("recall", tube.recall), ("precision", tube.precision), ("IoU", tube.iou)]:
            assert value == pytest.approx(row[measure], abs=5e-5)


def test_scores_of_whole_clouds_are_those_of_predictions(dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path) -> None:
    recalls = []
    for sample in tubebin.Dataset(dataset):
        labels = labels_with_errors(sample.cloud)
        path = tmp_path / f"{sample.name}.pcd"
        path.parent.mkdir(exist_ok=True)
        tubebin.write_cloud(path, tubebin.Cloud(sample.cloud.points, labels=labels))
        assert sample.cloud.labels is not None
        recalls.append(tubebin.evaluate(sample.cloud.labels, labels).micro_recall)
    result = json.loads(run("evaluate", dataset, "--predictions", tmp_path, "--format", "json", "--quiet"))
    means = {row["tubes"]: row["micro_recall"] for row in result["groups"]}
    assert [means[3], means[10]] == pytest.approx([np.mean(recalls[:2]), np.mean(recalls[2:])], abs=1e-6)


def test_labels_that_cannot_be_meant_are_named() -> None:
    with pytest.raises(ValueError, match="labels: one is -1; valid: whole numbers from 0"):
        tubebin.evaluate([1, 2], [-1, 2])
    with pytest.raises(ValueError, match=r"shape \(3,\); valid: that of truth, \(2,\)"):
        tubebin.evaluate([1, 2], [1, 2, 3])
    with pytest.raises(ValueError, match="labels: are no whole numbers"):
        tubebin.evaluate([1, 2], [0.5, 1.0])
