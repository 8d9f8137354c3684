"""Data sets for PyTorch: the same stream for any number of workers, splits, and orders that go on."""

from __future__ import annotations

import pathlib
import pickle
from typing import Any

import numpy as np
import pytest
from conftest import Run

import tubebin

torch: Any = pytest.importorskip("torch")

import torch.utils.data as data  # noqa: E402

import tubebin.torch  # noqa: E402

SMALL = {"scanner": {"width": 320, "height": 200}}  # pixels
TUBES = [1, 2]


def name_of(sample: tubebin.Sample) -> str:
    return sample.name


def names_of_batches(scenes: tubebin.torch.Scenes, batch_size: int | None, workers: int, **options: Any) -> list[Any]:
    return list(data.DataLoader(scenes, batch_size=batch_size, num_workers=workers, **options))


@pytest.mark.filterwarnings("ignore:This DataLoader will create")  # more workers than cores
@pytest.mark.parametrize("workers", [0, 1, 2, 3])
def test_batches_are_the_same_for_any_number_of_workers(workers: int) -> None:
    names = [f"A{tubes}/{case:03}" for case in range(1, 5) for tubes in TUBES]
    scenes = tubebin.torch.Scenes(SMALL, tubes=TUBES, cases=4, transform=name_of)
    assert names_of_batches(scenes, None, workers) == names
    threes = tubebin.torch.Scenes(SMALL, tubes=TUBES, cases=4, batch_size=3, transform=name_of)
    assert names_of_batches(threes, 3, workers) == [names[:3], names[3:6], names[6:]]
    assert names_of_batches(threes, 3, workers, drop_last=True) == [names[:3], names[3:6]]
    rest = tubebin.torch.Scenes(SMALL, tubes=TUBES, cases=4, start=5, batch_size=2, transform=name_of)
    assert names_of_batches(rest, 2, workers) == [names[5:7], names[7:]]


def test_scenes_are_those_of_generate_though_this_process_made_some_before() -> None:
    expected = [tubebin.generate(SMALL, tubes=3, seed=5, case=case).scan() for case in (1, 2, 3)]
    loader = data.DataLoader(tubebin.torch.Scenes(SMALL, 5, tubes=3), batch_size=None, num_workers=2)
    for case, (sample, cloud) in enumerate(zip(loader, expected), 1):  # the stream does not end
        assert sample["name"] == f"A3/{case:03}"
        np.testing.assert_array_equal(sample["points"].numpy(), cloud.points)
        np.testing.assert_array_equal(sample["labels"].numpy(), cloud.labels)
        assert sample["labels"].dtype == torch.int64


def test_a_stream_goes_to_a_process_that_shares_nothing() -> None:
    scenes = pickle.loads(pickle.dumps(tubebin.torch.Scenes(SMALL, tubes=1, cases=2)))
    assert [sample["name"] for sample in scenes] == ["A1/001", "A1/002"]


def test_a_scene_that_no_attempt_gives_is_the_loaders_error() -> None:
    scenes = tubebin.torch.Scenes({"scanner": {"range_max": 0.2}, "attempts_max": 2}, tubes=1)
    with pytest.raises(tubebin.GenerationError, match="A1/001: given up after 2 attempts"):
        next(iter(data.DataLoader(scenes, batch_size=None, num_workers=1)))


def test_wrong_arguments_are_named_before_a_worker_starts() -> None:
    with pytest.raises(tubebin.ConfigError, match="batch_size: '0' is not valid; valid: whole numbers from 1"):
        tubebin.torch.Scenes({}, batch_size=0)
    with pytest.raises(tubebin.ConfigError, match="tubes: has no number; valid: one or several, from 1"):
        tubebin.torch.Scenes({}, tubes=[])
    with pytest.raises(tubebin.ConfigError, match=r"tube\.radius"):
        tubebin.torch.Scenes({"tube": {"radius": -1}})
    with pytest.raises(tubebin.ConfigError, match="nowhere.yaml: cannot be read"):
        tubebin.torch.Scenes("nowhere.yaml")


def test_a_dataset_is_read_by_workers_loose_and_packed(dataset: pathlib.Path, run: Run, tmp_path: pathlib.Path) -> None:
    config = dataset / "config.yaml"
    arguments = ["--tubes", "3,10", "--cases", "2", "--seed", "7", "--pack", "--quiet"]
    run("generate_dataset", config, "--output", tmp_path / "packed", *arguments)
    expected = list(tubebin.Dataset(dataset))
    for folder in [dataset, tmp_path / "packed"]:
        samples = list(data.DataLoader(tubebin.torch.Dataset(folder), batch_size=None, num_workers=2))
        assert [sample["name"] for sample in samples] == [sample.name for sample in expected]
        for sample, there in zip(samples, expected):
            np.testing.assert_array_equal(sample["points"].numpy(), there.cloud.points)
            np.testing.assert_array_equal(sample["labels"].numpy(), there.cloud.labels)


def test_depth_images_come_in_tensors(depth_dataset: pathlib.Path) -> None:
    scenes = tubebin.torch.Dataset(depth_dataset, transform=tubebin.torch.depth_tensors)
    samples = list(data.DataLoader(scenes, batch_size=None, num_workers=2))
    assert [sample["name"] for sample in samples] == ["A3/001", "A3/002"]
    for sample, there in zip(samples, tubebin.Dataset(depth_dataset)):
        np.testing.assert_array_equal(sample["depth"].numpy(), there.depth_image.depth)
        np.testing.assert_array_equal(sample["labels"].numpy(), there.cloud.labels)
        assert sample["labels"].dtype == torch.int64 and sample["intrinsics"].shape == (3, 3)


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """300 clouds of one point; the last fifty are steps of ten piles."""
    folder = tmp_path_factory.mktemp("many")
    names = [f"A1/{k:03}" for k in range(250)] + [f"A5/{k:03}/step_{step:02}" for k in range(10) for step in range(5)]
    for name in names:
        (folder / name).mkdir(parents=True)
        tubebin.write_cloud(folder / name / "cloud.pcd", tubebin.Cloud(np.zeros((1, 3))))
    return folder


def names_of_parts(folder: pathlib.Path, **options: Any) -> list[list[str]]:
    parts = ("train", "validation", "test")
    return [tubebin.torch.Dataset(folder, part, **options).names for part in parts]  # type: ignore[arg-type]


def test_a_split_has_each_scene_once_and_keeps_it_when_scenes_are_added(
    many: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    parts = names_of_parts(many)
    assert sorted(sum(parts, [])) == sorted(tubebin.Dataset(many).names) == sorted(tubebin.torch.Dataset(many).names)
    train, validation, test = (len(part) / 300 for part in parts)
    assert 0.7 < train < 0.9 and 0.04 < validation < 0.17 and 0.04 < test < 0.17
    for pile in range(10):
        assert sum(any(f"A5/{pile:03}/" in name for name in part) for part in parts) == 1
    few = tmp_path / "few"
    few.mkdir()
    for name in ["A1/003", "A1/100", *parts[1][:2], *parts[2][:2]]:
        (few / name).mkdir(parents=True, exist_ok=True)
        tubebin.write_cloud(few / name / "cloud.pcd", tubebin.Cloud(np.zeros((1, 3))))
    for of_few, of_many in zip(names_of_parts(few), parts):
        assert set(of_few) <= set(of_many)


def test_fractions_say_how_large_the_parts_are(many: pathlib.Path) -> None:
    half, quarter, other = (len(part) / 300 for part in names_of_parts(many, fractions=(0.5, 0.25, 0.25)))
    assert 0.4 < half < 0.6 and 0.17 < quarter < 0.33 and 0.17 < other < 0.33
    with pytest.raises(tubebin.ConfigError, match="none of its 300 scenes is in split 'test'"):
        tubebin.torch.Dataset(many, "test", fractions=(0.5, 0.5, 0))
    with pytest.raises(tubebin.ConfigError, match="three numbers from 0 that add up to 1"):
        tubebin.torch.Dataset(many, fractions=(0.5, 0.1, 0.1))
    with pytest.raises(tubebin.ConfigError, match="split: 'val' is not valid; valid: train, validation, test"):
        tubebin.torch.Dataset(many, "val")  # type: ignore[arg-type]


def test_an_order_shuffles_by_seed_and_epoch_and_goes_on(many: pathlib.Path) -> None:
    scenes = tubebin.torch.Dataset(many, "train")
    order = scenes.order(7, epoch=2)
    assert sorted(order) == list(range(len(scenes)))
    assert order == tubebin.torch.Dataset(many, "train").order(7, epoch=2)
    others = [scenes.order(7), scenes.order(8), scenes.order(8, epoch=2), list(range(len(scenes)))]
    assert all(order != other for other in others) and others[0] != others[1]
    loader = data.DataLoader(scenes, batch_size=4, sampler=scenes.order(7, epoch=2, start=20), num_workers=2)
    seen = [name for batch in loader for name in batch["name"]]
    assert seen == [scenes.names[index] for index in order[20:]]
