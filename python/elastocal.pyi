# SPDX-License-Identifier: Apache-2.0
"""Elasto-geometric calibration of robots. SI units and radians everywhere; arrays are NumPy's, files are str or
Path. Long calls let other threads run and end on Ctrl-C. An argument with a unit as suffix (_mm) is in that unit."""

from os import PathLike
from typing import Any, Callable, Mapping, Optional, Sequence, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = Union[str, "PathLike[str]"]
_Array = NDArray[np.float64]
_Positions = Union[ArrayLike, Mapping[str, float]]
_Progress = Optional[Callable[[int, int], None]]

class InputError(ValueError):
    """A file or value that cannot be used: where, what was found and what was expected."""

class InfeasibleError(RuntimeError):
    """The limits leave no posture or no motion: which, and why."""

class Robot:
    """A nominal robot, as its URDF describes it."""

    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]:
        """Joints that are entries of q, in its order; mimic joints are not."""
    @property
    def links(self) -> list[str]:
        """The root link first."""
    @property
    def lower(self) -> _Array:
        """Least positions (joints,), rad or m; -inf without a limit."""
    @property
    def upper(self) -> _Array:
        """Largest positions (joints,), rad or m; inf without a limit."""
    @property
    def velocity(self) -> _Array:
        """Largest speeds (joints,), rad/s or m/s."""
    @property
    def effort(self) -> _Array:
        """Largest torques (joints,), N.m, or forces, N."""
    def poses(self, q: _Positions) -> dict[str, _Array]:
        """Poses (4, 4) of all links in the root link's frame, without deflection; q: (joints,) or a dict of joints."""

class Project:
    """A project file with its robot."""

    def __init__(self, file: _Path) -> None: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def file(self) -> str: ...
    @property
    def urdf(self) -> str: ...
    @property
    def joints(self) -> list[str]:
        """Joints that are entries of q, in its order."""
    @property
    def chains(self) -> list[str]: ...
    @property
    def markers(self) -> list[str]: ...
    @property
    def rest(self) -> _Array:
        """Posture of rest (joints,), rad or m: of joints that a posture leaves out."""

class Calibration:
    """What calibrate() found."""

    @property
    def deployable(self) -> bool:
        """Whether the calibration can be trusted; if not, see `objections`."""
    @property
    def status(self) -> str:
        """'converged', 'not converged', 'failed' or 'implausible'."""
    @property
    def objections(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def urdf_rmse_mm(self) -> float:
        """Root mean square of the markers' distances to what the calibrated URDF alone predicts."""
    @property
    def parameters(self) -> list[str]:
        """Names, in the order of `values`."""
    @property
    def values(self) -> _Array:
        """Errors (parameters,), rad, m and their ratios."""
    @property
    def sd(self) -> _Array:
        """Standard deviations (parameters,); NaN where none applies."""
    @property
    def summary(self) -> dict[str, Any]:
        """The dict of summary.json."""
    @property
    def files(self) -> dict[str, str]:
        """Texts of the files that `elastocal calibrate` writes, by name."""
    def save(self, folder: _Path) -> None: ...

class Design:
    """Calibration postures that design() found."""

    @property
    def postures(self) -> dict[str, _Array]:
        """By chain (or plate), an array (postures, joints), rad or m."""
    @property
    def support(self) -> dict[str, list[str]]:
        """By chain, the links that stand on the floor meanwhile."""
    @property
    def summary(self) -> dict[str, Any]:
        """The dict of `elastocal design --json`."""
    @property
    def warnings(self) -> list[str]: ...
    @property
    def text(self) -> str:
        """The posture file."""
    def save(self, file: _Path) -> None: ...

class Plan:
    """A motion of the whole robot that plan() found."""

    @property
    def time_s(self) -> _Array:
        """(samples,), s."""
    @property
    def positions(self) -> _Array:
        """(samples, joints), rad or m, by Project.joints."""
    @property
    def torques(self) -> _Array:
        """Expected of the motors, (samples, joints), N.m or N."""
    @property
    def zmp(self) -> _Array:
        """Zero-moment point on the floor, (samples, 2), m."""
    @property
    def support(self) -> list[list[str]]:
        """By sample, the links that stand on the floor."""
    @property
    def left_out(self) -> list[str]: ...
    @property
    def broken(self) -> list[str]:
        """Limits that the motion breaks; of a balanced one, none."""
    @property
    def summary(self) -> dict[str, Any]:
        """The dict of `elastocal plan --json`."""
    def save(self, file: _Path, *, trajectory: _Path = "", per_chain: _Path = "") -> None: ...

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

class _MotionDict(TypedDict, total=False):
    time_s: ArrayLike
    positions: ArrayLike
    support: Sequence[Sequence[str]]

_Postures = Union[Design, _Path, Mapping[str, Union[ArrayLike, Sequence[Mapping[str, float]]]]]

def calibrate(
    project: Project,
    recordings: Union[_Path, Sequence[_Path]],
    *,
    folds: Optional[int] = None,
    fold_by: str = "posture",
    seed: Optional[int] = None,
    threads: int = 1,
    zero_offsets: str = "origin",
    prior: _Path = "",
    days: float = 1.0,
    accept: Sequence[str] = ...,
    progress: Optional[Callable[[str, int, int], None]] = None,
) -> Calibration: ...
def validate(
    project: Project,
    calibration: _Path,
    recording: _Path,
    *,
    frozen: bool = False,
    seed: Optional[int] = None,
    accept: Sequence[str] = ...,
) -> dict[str, Any]: ...
def check(
    project: Project,
    calibration: _Path,
    recording: _Path,
    *,
    level: float = 0.05,
    days: float = 1.0,
    seed: Optional[int] = None,
    accept: Sequence[str] = ...,
) -> dict[str, Any]: ...
def compare(a: _Path, b: _Path, *, level: float = 0.05) -> dict[str, Any]: ...
def read(file: _Path, *, unit: str = "", topic: str = "") -> _Recording: ...
def info(file: _Path, *, unit: str = "", topic: str = "") -> dict[str, Any]: ...
def write_table(
    project: Project,
    file: _Path,
    positions: ArrayLike,
    markers: ArrayLike,
    *,
    marker_names: Optional[Sequence[str]] = None,
) -> None: ...
def design(
    project: Project,
    *,
    chains: Sequence[str] = ...,
    count: Optional[int] = None,
    max_count: int = ...,
    plateau: float = ...,
    block: int = ...,
    algorithm: str = "nocp",
    criterion: str = "O1",
    elastic: bool = False,
    curves: bool = False,
    certificate: bool = True,
    seed: int = 1,
    progress: _Progress = None,
) -> Design: ...
def design_after(
    project: Project,
    calibration: _Path,
    *,
    check: bool = False,
    count: int = ...,
    chains: Sequence[str] = ...,
    joints: Sequence[str] = ...,
    days: float = ...,
    marker_noise_mm: float = ...,
    seed: int = 1,
    progress: _Progress = None,
) -> Design: ...
def plan(
    project: Project,
    postures: Optional[_Postures] = None,
    *,
    kind: Optional[str] = None,
    count: int = ...,
    move_s: float = ...,
    rest_s: float = ...,
    zmp_margin_mm: Optional[float] = None,
    lift_mm: Optional[float] = None,
    inset_mm: Optional[float] = None,
    torque_share: float = ...,
    velocity_share: float = ...,
    balanced: bool = True,
    robots: int = 0,
    floor_friction: float = ...,
    leg_geometry_scale: float = ...,
    stabilised: bool = True,
    threads: int = ...,
    seed: int = 1,
    progress: _Progress = None,
) -> Plan: ...
def simulate(
    project: Project,
    folder: _Path,
    *,
    motion: Optional[Union[Plan, _Path, _MotionDict]] = None,
    postures: Optional[_Postures] = None,
    trials: str = "all",
    kind: Optional[str] = None,
    chains: Sequence[str] = ...,
    settings: Optional[Union[_Path, Mapping[str, Union[float, str, ArrayLike]]]] = None,
    nominal: bool = False,
    matched: bool = False,
    free: bool = False,
    force: bool = False,
    count: int = ...,
    seed: int = 1,
    robot_seed: Optional[int] = None,
    threads: int = ...,
    progress: _Progress = None,
) -> dict[str, Any]: ...
def simulation_settings() -> dict[str, dict[str, str]]: ...

class Runtime:
    """The calibrated robot in a controller. One thread at a time."""

    def __init__(
        self, calibration: _Path, project: _Path = "", content: str = "everything"
    ) -> None: ...
    @property
    def joints(self) -> list[str]:
        """Joints that are entries of q, in its order."""
    @property
    def links(self) -> list[str]: ...
    @property
    def feet(self) -> list[str]:
        """Links of the feet, in the order of the bits of `feet`."""
    def forward(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> dict[str, Any]:
        """Poses (4, 4) in m of all 'links' in the root link's frame, with deflection, of the 'root', and the 'status'."""
    def command(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> _Array:
        """Positions (joints,) to command so that hands and feet go where the nominal robot has them at q."""
    def correct(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> _Array:
        """Positions (joints,) at which a rigid calibrated robot has its hands where the real one has them."""
