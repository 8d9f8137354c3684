"""Data sets for PyTorch's loaders, simulated in their workers or read from disk: pip install tubebin[torch].

A sample is what `transform` makes of a tubebin.Sample, in the process that made or read it; `tensors` where none is given.
"""

from __future__ import annotations

import hashlib
import itertools
import math
import operator
import os
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal

import numpy as np

try:
    import torch
    from torch.utils import data
except ImportError as error:
    raise ImportError(f"tubebin.torch needs PyTorch, which `pip install tubebin[torch]` brings: {error}") from error

from . import _core, _dataset, generate
from ._config import Config, core_config

__all__ = ["Dataset", "Scenes", "depth_tensors", "tensors"]

Transform = Callable[[_dataset.Sample], Any]


def tensors(sample: _dataset.Sample) -> dict[str, Any]:
    """name; points (H, W, 3) or (N, 3) float32, metres, world frame, NaN of no hit; labels (H, W) or (N,) int64.

    Images of different scenes differ in size: a loader that batches them needs a transform that cuts or pads.
    """
    points = {"name": sample.name, "points": torch.from_numpy(sample.cloud.points)}
    if sample.cloud.labels is None:
        return points
    return {**points, "labels": torch.from_numpy(sample.cloud.labels.astype(np.int64))}


def depth_tensors(sample: _dataset.Sample) -> dict[str, Any]:
    """name; depth (H, W) float32, metres along the optical axis, 0 of no hit; labels (H, W) int64; intrinsics (3, 3) float64.

    A transform for data sets with `output.depth_image`, of which it reads no cloud, and for those without. Sizes as of tensors.
    """
    image = sample.depth_image
    return {
        "name": sample.name,
        "depth": torch.from_numpy(image.depth),
        "labels": torch.from_numpy(image.labels.astype(np.int64)),
        "intrinsics": torch.from_numpy(image.intrinsics),
    }


class Scenes(data.IterableDataset[Any]):
    """A stream of scenes that the loader's workers simulate: nothing is written, and no two are alike.

    config, seed: as of tubebin.generate.
    tubes: in a scene; of several numbers, one after the other in turn.
    cases: of each number of tubes; without it the stream does not end.
    start: samples of the stream to leave out, those that a training has seen.
    batch_size: that of the loader; 1 where the loader has none or None.
    transform: makes a sample of a tubebin.Sample.

    With n numbers of tubes, sample i (from 0) is the scene that tubebin.generate makes of tubes[i % n] and case i // n + 1.
    Of W workers, worker w makes batches w, w + W, w + 2 W, ..., which is how a loader asks for them. So a loader's batches are
    the same and in the same order for any number of workers, as long as batch_size is the loader's. Each iteration begins
    at `start` again.

    Raises ConfigError; in a loader GenerationError where no attempt gave a scene.
    """

    def __init__(
        self,
        config: Config,
        seed: int = 7,
        *,
        tubes: int | Sequence[int] = 10,
        cases: int | None = None,
        start: int = 0,
        batch_size: int = 1,
        transform: Transform = tensors,
    ) -> None:
        core_config(config)  # raises what a worker would
        self._config = config
        self._seed = operator.index(seed)
        self._tubes = [_at_least(1, count, "tubes") for count in np.atleast_1d(tubes).tolist()]
        if not self._tubes:
            raise _core.ConfigError("tubes: has no number; valid: one or several, from 1")
        self._end = math.inf if cases is None else _at_least(1, cases, "cases") * len(self._tubes)
        self._start = _at_least(0, start, "start")
        self._batch_size = _at_least(1, batch_size, "batch_size")
        self._transform = transform

    def __iter__(self) -> Iterator[Any]:
        info = data.get_worker_info()
        worker, workers = (0, 1) if info is None else (info.id, info.num_workers)
        for batch in itertools.count(worker, workers):
            first = self._start + batch * self._batch_size
            for position in range(first, first + self._batch_size):
                if position >= self._end:
                    return
                yield self._transform(self._simulate(position))

    def _simulate(self, position: int) -> _dataset.Sample:
        case, which = divmod(position, len(self._tubes))
        scene = generate(self._config, self._tubes[which], self._seed, case=case + 1)
        return _dataset.Sample(scene.id, scene.scan, scene.depth_image, lambda: scene)


class Dataset(data.Dataset[Any]):
    """The scenes of a data set's folder, loose or packed, or of a single pack: all, or those of one part of a split.

    split: "train", "validation" or "test". A scene's name alone decides which part it is in, so that a part keeps its scenes
        when the data set grows; the steps of emptying one bin are in one part.
    fractions: expected size of the parts, in this order; they add up to 1.
    transform: makes a sample of a tubebin.Sample.

    Raises IoError where the folder has no scene, ConfigError where the part has none.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        split: Literal["train", "validation", "test"] | None = None,
        *,
        fractions: Sequence[float] = (0.8, 0.1, 0.1),
        transform: Transform = tensors,
    ) -> None:
        self._scenes = _dataset.Dataset(folder)
        self._transform = transform
        part = _part(split, fractions)
        self.names = [name for name in self._scenes.names if part(name)]  #: of the scenes, in order
        if not self.names:
            count = len(self._scenes)
            raise _core.ConfigError(f"{self._scenes.folder}: none of its {count} scenes is in split '{split}'")

    def __len__(self) -> int:
        return len(self.names)

    def __getitem__(self, index: int) -> Any:
        return self._transform(self._scenes[self.names[index]])

    def order(self, seed: int, epoch: int = 0, *, start: int = 0) -> list[int]:
        """Indices of all samples, shuffled by seed and epoch, without the first `start`: for a loader's `sampler`.

        The same on every machine; so a training that was interrupted after `start` samples of an epoch goes on with the rest.
        """
        key = f"{operator.index(seed)} {operator.index(epoch)} "
        shuffled = sorted(range(len(self)), key=lambda index: _hash(key + self.names[index]))
        return shuffled[_at_least(0, start, "start") :]


def _part(split: str | None, fractions: Sequence[float]) -> Callable[[str], bool]:
    """Whether a scene of this name is in the part."""
    splits = ("train", "validation", "test")
    if len(fractions) != 3 or min(fractions) < 0 or not math.isclose(sum(fractions), 1):
        raise _core.ConfigError(f"fractions: {fractions} are not valid; valid: three numbers from 0 that add up to 1")
    if split is None:
        return lambda name: True
    if split not in splits:
        raise _core.ConfigError(f"split: '{split}' is not valid; valid: {', '.join(splits)}")
    ends = [0.0, fractions[0], fractions[0] + fractions[1], math.inf]
    begin, end = ends[splits.index(split) :][:2]
    return lambda name: begin <= _hash(re.sub(r"/step_\d+$", "", name)) / 2**64 < end


def _hash(text: str) -> int:
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "big")


def _at_least(least: int, value: int, name: str) -> int:
    if operator.index(value) < least:
        raise _core.ConfigError(f"{name}: '{value}' is not valid; valid: whole numbers from {least}")
    return operator.index(value)
