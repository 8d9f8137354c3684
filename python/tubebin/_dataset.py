"""Scenes of a data set by number or name."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial

from . import _core


class Sample:
    """One scene with its cloud; those of a data set are read when they are asked for."""

    def __init__(
        self,
        name: str,
        cloud: Callable[[], _core.Cloud],
        depth_image: Callable[[], _core.DepthImage],
        scene: Callable[[], _core.Scene | None],
    ) -> None:
        self.name = name  #: "A10/007": set A, ten tubes, case 7
        self._cloud = cloud
        self._depth_image = depth_image
        self._scene = scene

    @cached_property
    def cloud(self) -> _core.Cloud:
        """The cloud as it was written, with the ground truth's labels. Raises IoError."""
        return self._cloud()

    @cached_property
    def depth_image(self) -> _core.DepthImage:
        """The cloud's pixels as an image: depth.png and labels.png, or the same from the cloud where they are not there.

        Raises IoError, also where the cloud is not organized.
        """
        return self._depth_image()

    @cached_property
    def scene(self) -> _core.Scene | None:
        """What scene.json says; None where there is none. Raises IoError."""
        return self._scene()


class Dataset(Sequence[Sample]):
    """The scenes of a data set's folder, loose or packed, or of a single pack; scenes of fewer tubes first.

    dataset[3], dataset["A10/007"] and iteration read nothing yet: each Sample reads what it is asked for, wherever it
    lies in its pack. Scenes that are added later are not seen. Raises IoError where the folder has no scene.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        self._files = _core.DatasetFiles(self.folder)
        self.names: list[str] = self._files.names()  #: of all scenes, in order
        self._known = frozenset(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __getitem__(self, key: int | str) -> Sample:  # type: ignore[override]  # no slices
        if not isinstance(key, str):
            return self._sample(self.names[operator.index(key)])
        if key not in self._known:
            raise KeyError(f"{self.folder}: has no scene {key}")
        return self._sample(key)

    def __iter__(self) -> Iterator[Sample]:
        return map(self._sample, self.names)

    def __reduce__(self) -> tuple[type[Dataset], tuple[str]]:
        return (type(self), (self.folder,))  # for processes of its own, as a data loader starts them

    def _sample(self, name: str) -> Sample:
        files = self._files
        return Sample(
            name,
            partial(files.read_cloud, name),
            partial(files.read_depth_image, name),
            partial(files.read_scene, name),
        )
