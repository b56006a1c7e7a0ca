# SPDX-License-Identifier: Apache-2.0
"""Elasto-geometric calibration of robots. SI units and radians everywhere."""

from os import PathLike
from typing import Any, Optional, Sequence, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = Union[str, "PathLike[str]"]
_Array = NDArray[np.float64]

class InputError(ValueError):
    """A file or value that cannot be used; says where, what was found and what was expected."""

class Project:
    """A project file with its robot."""

    def __init__(self, file: _Path) -> None: ...
    @property
    def robot(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def urdf(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def chains(self) -> list[str]: ...
    @property
    def markers(self) -> list[str]: ...

class Calibration:
    """What calibrate() found."""

    @property
    def deployable(self) -> bool: ...
    @property
    def status(self) -> str: ...
    @property
    def objections(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def urdf_rmse_mm(self) -> float: ...
    @property
    def parameters(self) -> list[str]: ...
    @property
    def values(self) -> _Array: ...
    @property
    def sd(self) -> _Array: ...
    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def files(self) -> dict[str, str]: ...
    def save(self, folder: _Path) -> None: ...

class _Markers(TypedDict):
    names: list[str]
    rate_hz: float
    positions: _Array
    up: Optional[str]

class _Joints(TypedDict):
    names: list[str]
    time_s: _Array
    positions: _Array
    torques: _Array

class _Recording(TypedDict):
    format: str
    markers: Optional[_Markers]
    joints: Optional[_Joints]
    notes: list[str]

def calibrate(
    project: Project,
    recordings: Sequence[_Path],
    *,
    folds: Optional[int] = None,
    seed: Optional[int] = None,
    threads: int = 1,
    zero_offsets: str = "origin",
    prior: _Path = "",
    days: float = 1.0,
) -> Calibration: ...
def validate(
    project: Project, calibration: _Path, recording: _Path, *, frozen: bool = False
) -> dict[str, Any]: ...
def check(
    project: Project,
    calibration: _Path,
    recording: _Path,
    *,
    level: float = 0.05,
    days: float = 1.0,
) -> dict[str, Any]: ...
def compare(a: _Path, b: _Path, *, level: float = 0.05) -> dict[str, Any]: ...
def read(file: _Path, *, unit: str = "", topic: str = "") -> _Recording: ...
def info(file: _Path, *, unit: str = "", topic: str = "") -> dict[str, Any]: ...

class Runtime:
    """The calibrated robot in a controller."""

    def __init__(
        self, calibration: _Path, project: _Path = "", content: str = "everything"
    ) -> None: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def links(self) -> list[str]: ...
    @property
    def feet(self) -> list[str]: ...
    def forward(self, q: ArrayLike, torque: ArrayLike = ..., feet: int = 0) -> dict[str, Any]: ...
    def command(self, q: ArrayLike, torque: ArrayLike = ..., feet: int = 0) -> _Array: ...
    def correct(self, q: ArrayLike, torque: ArrayLike = ..., feet: int = 0) -> _Array: ...
