"""Configurations as files or dicts, for the core that reads YAML."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, Union

import numpy as np

from . import _core

Config = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def core_config(config: Config) -> _core.Config:
    if isinstance(config, Mapping):
        return _core.parse_config(as_json(config))
    return _core.load_config(os.fspath(config))


def core_model_config(config: Config | None) -> _core.ModelConfig:
    if config is None or isinstance(config, Mapping):
        return _core.parse_model_config(as_json(config or {}))
    return _core.load_model_config(os.fspath(config))


def as_json(values: Mapping[str, Any]) -> str:
    """As JSON, which is YAML, too."""
    return json.dumps(values, default=_plain)


def _plain(value: Any) -> Any:
    """Of numpy's numbers and arrays, which JSON does not know."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise _core.ConfigError(f"config: {value!r} is a {type(value).__name__}; valid: numbers, texts, lists and dicts")
