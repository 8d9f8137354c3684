"""Entangled tubes in a bin: generate, scan, model, evaluate.

Metres, radians and seconds. World frame: origin at the middle of the bin's inner floor, z up. Label 0 is the bin (or no
tube), label k is tube k. What a file or value lacks is an IoError (an OSError) or a ConfigError (a ValueError) that names
the place and what would be right. Long calls release the interpreter's lock, so that threads run beside each other.
"""

from __future__ import annotations

import operator
import os
import warnings
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _core
from ._config import Config, as_json, core_config, core_model_config
from ._core import (
    Cloud,
    ConfigError,
    DepthImage,
    Evaluation,
    GenerationError,
    IoError,
    Model,
    Scene,
    Tube,
    TubeScore,
)
from ._dataset import Dataset, Sample

__version__ = _core.tool_version()

__all__ = [
    "Cloud",
    "Config",
    "ConfigError",
    "Dataset",
    "DepthImage",
    "Evaluation",
    "GenerationError",
    "IoError",
    "Model",
    "ModelWarning",
    "Sample",
    "Scene",
    "Tube",
    "TubeScore",
    "__version__",
    "evaluate",
    "generate",
    "model",
    "read_cloud",
    "write_cloud",
]


class ModelWarning(UserWarning):
    """A reason not to trust a model; Model.warnings has all of them."""


def generate(config: Config, tubes: int = 10, seed: int = 7, *, case: int = 1) -> Scene:
    """Lets tubes fall into a bin until they are proven to be at rest.

    config: a YAML file, or a dict of its keys (docs/configuration.md; {} is set A of the paper).
    tubes, seed, case: the scene is that of `generate_dataset --tubes TUBES --seed SEED` with this case, byte by byte.

    Raises ConfigError, or GenerationError where no attempt gave a scene.
    """
    request = {"tubes": [operator.index(tubes)], "seed": operator.index(seed), "cases": operator.index(case)}
    return _core.generate(core_config(config), as_json(request))


def model(
    points: npt.ArrayLike,
    viewpoint: npt.ArrayLike,
    radius: float | Sequence[float] | None = None,
    *,
    tube_length: float | None = None,
    ratio: float | None = None,
    method: Literal["centerline", "region_growing"] | None = None,
    config: Config | None = None,
) -> Model:
    """Finds the tubes in a cloud by its positions alone.

    points: (H, W, 3) of an organized cloud or (N, 3), metres; not finite where nothing was measured.
    viewpoint: where the sensor stood in the points' frame: its position (3,), metres, or its pose (4, 4), as
        Cloud.viewpoint is; zeros for a cloud in the camera's frame.
    radius: outer radius of the tubes, metres, or several; estimated without it.
    tube_length: length of every tube, metres; estimated without it.
    ratio: part of the points that are worked on, above 0 and up to 1; all are labelled.
    method: "centerline" (without it) or "region_growing", the paper's.
    config: further options, a YAML file or a dict of its keys (docs/modeling.md).

    Labels and tubes are those of `model_tubes`, bit by bit. Where the bin is known, say so as that program's
    configuration does: config={"bin_source": "config", "bin": {"length": 0.55, "width": 0.37, "height": 0.2}}.

    Raises ConfigError, or IoError where no point is finite. Warns with ModelWarning where the result may not be trusted.
    """
    request: dict[str, Any] = {}
    if radius is not None:
        first, *others = np.atleast_1d(np.asarray(radius, dtype=float)).tolist()
        request["radius"] = first
        if others:
            request["other_radii"] = [{"radius": other} for other in others]
    if tube_length is not None:
        request["tube_length"] = tube_length
    if ratio is not None:
        request["filtering"] = {"ratio": ratio}
    if method is not None:
        request["method"] = method
    positions = np.ascontiguousarray(points, dtype=np.float32)
    pose = np.ascontiguousarray(viewpoint, dtype=np.float64)
    found = _core.model(positions, pose, core_model_config(config), as_json(request))
    for reason in found.warnings:
        warnings.warn(reason, ModelWarning, stacklevel=2)
    return found


def evaluate(
    truth: npt.ArrayLike, labels: npt.ArrayLike, *, bin_points: Literal["left_out", "counted"] = "left_out"
) -> Evaluation:
    """Matches labels with the ground truth, and counts.

    truth: whole numbers of any shape, one a point: k of tube k, 0 of the bin.
    labels: as many, in the same order: any number from 1 for each tube that was found, 0 of no tube.
    bin_points: "left_out", as `evaluate --predictions` does with whole clouds: only the points of tubes count for
        micro-recall. "counted", as `evaluate --filtered` does: the bin is one more segment to be found.
    """
    truth, labels = np.asarray(truth), np.asarray(labels)
    if truth.shape != labels.shape:
        raise ConfigError(f"labels: have the shape {labels.shape}; valid: that of truth, {truth.shape}")
    if bin_points not in ("left_out", "counted"):
        raise ConfigError(f"bin_points: '{bin_points}' is not valid; valid: left_out, counted")
    return _core.evaluate(truth, labels, bin_points == "counted")


def read_cloud(path: str | os.PathLike[str], scale: float = 1.0) -> Cloud:
    """Reads a PCD or PLY file, of whatever encoding; scale: from the file's unit to metres, 0.001 for millimetres."""
    return _core.read_cloud(os.fspath(path), scale)


def write_cloud(
    path: str | os.PathLike[str],
    cloud: Cloud,
    format: Literal["pcd_binary", "pcd_compressed", "pcd_ascii", "ply_binary"] | None = None,
) -> None:
    """Writes the cloud, whole or not at all; without a format, binary PCD or PLY by the file's name."""
    _core.write_cloud(os.fspath(path), cloud, format or "")
