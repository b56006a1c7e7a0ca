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
    def name(self) -> str:
        """As in the URDF."""
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
        """Poses (4, 4) of all links in the root link's frame, by name, without deflection. q: (joints,), rad or m,
        or a dict of joints, the others being at 0."""

class Project:
    """A project file with its robot."""

    def __init__(self, file: _Path) -> None:
        """Reads a project file (YAML; docs/formats.md)."""
    @property
    def robot(self) -> Robot:
        """Its nominal robot."""
    @property
    def file(self) -> str:
        """The project file."""
    def __fspath__(self) -> str:
        """The project file, so that a project can be given wherever its file can."""
    @property
    def urdf(self) -> str:
        """The robot description."""
    @property
    def joints(self) -> list[str]:
        """Joints that are entries of q, in its order."""
    @property
    def chains(self) -> list[str]:
        """Names of the chains that are calibrated."""
    @property
    def markers(self) -> list[str]:
        """Names of all markers."""
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
    def objections(self) -> list[str]:
        """Why it cannot be trusted, a sentence each."""
    @property
    def warnings(self) -> list[str]:
        """What a user should know, a sentence each."""
    @property
    def urdf_rmse_mm(self) -> float:
        """Root mean square of the markers' distances to what the calibrated URDF alone predicts, on the recording
        that it was fitted to; NaN of a project with contact or instruments (its errors: summary['contact'])."""
    @property
    def held_out_rmse_mm(self) -> float:
        """The same on trials or postures that were not used for the fit, the first figure that the program prints;
        NaN where nothing was held out (folds=0), and where urdf_rmse_mm is."""
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
    def save(self, folder: _Path) -> None:
        """Writes these files, runs.json and the report, as `elastocal calibrate -o` does."""

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
        """The dict of `elastocal design --json`: index, bound, efficiency of each chain ..."""
    @property
    def warnings(self) -> list[str]:
        """What a user should know, a sentence each."""
    @property
    def text(self) -> str:
        """The posture file."""
    def save(self, file: _Path) -> None:
        """Writes the posture file (YAML) and, as the program does, summary and curves beside it."""

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
    def left_out(self) -> list[str]:
        """What of the postures is left out, and why, a sentence each."""
    @property
    def broken(self) -> list[str]:
        """Limits that the motion breaks; of a balanced one, none."""
    @property
    def summary(self) -> dict[str, Any]:
        """The dict of `elastocal plan --json`: visits, margins, and how the robots that tried it came through."""
    def save(self, file: _Path, *, trajectory: _Path = "", per_chain: _Path = "") -> None:
        """Writes the motion (CSV) and its margins beside it. trajectory: a file, also as a ROS
        trajectory_msgs/JointTrajectory (YAML). per_chain: a folder, also a motion for each chain."""

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
    project: Union[Project, _Path],
    recordings: Union[_Path, Sequence[_Path]],
    *,
    folds: Optional[int] = None,
    fold_by: str = "posture",
    seed: Optional[int] = None,
    threads: int = 1,
    zero_offsets: str = "origin",
    prior: _Path = "",
    days: float | None = None,
    marker_places: _Path = "",
    accept: Sequence[str] = ...,
    progress: Optional[Callable[[str, int, int], None]] = None,
) -> Calibration:
    """Calibrates from a posture table or from recording folders (a path or several), like the command of that name;
    with contact or instruments, from tables of observations. folds: of the cross-validation, 0 for none; None: ten
    for a table. fold_by: what a fold leaves out, 'posture', 'trial' or 'session'. prior: the folder of an earlier
    calibration, `days` ago (None: one). marker_places: a table of where markers are on their links, as measured there. accept: mistakes of the recording to undo. progress: called with (step, done, total)."""
def validate(
    project: Union[Project, _Path],
    calibration: _Path,
    recording: Union[_Path, Sequence[_Path]],
    *,
    frozen: bool = False,
    refit: Optional[str] = None,
    seed: Optional[int] = None,
    accept: Sequence[str] = ...,
) -> dict[str, Any]:
    """Applies a saved calibration to another recording (with contact or instruments, tables of observations): the
    dict of validation.json. frozen: waist and markers are not fitted anew. refit: 'table' registers tables and
    trackers anew, for each posture by the others."""
def check(
    project: Union[Project, _Path],
    calibration: _Path,
    recording: Union[_Path, Sequence[_Path]],
    *,
    level: float = 0.05,
    days: float = 1.0,
    seed: Optional[int] = None,
    accept: Sequence[str] = ...,
    new_markers: bool = False,
) -> dict[str, Any]:
    """Tells from a few postures (with contact or instruments, tables of observations) whether a saved calibration
    still holds: the dict of `elastocal check --json`, of markers with the 'next_postures' to record where several
    joints may have changed. level: chance of a false alarm. days: since the calibration. new_markers: markers were
    taken off since."""
def compare(a: _Path, b: _Path, *, level: float = 0.05, new_markers: bool = False) -> dict[str, Any]:
    """Tells which joints moved between two saved calibrations: a dict with 'changed', 'moved', 'or_markers' (by
    moved joint, links whose markers may have moved as one piece instead), 'suspects', 'markers' (by link, whether
    they are 'same'), 'soles' (springs, m/N), 'warnings' and 'parameters' (values in SI units). new_markers: markers were taken off in
    between."""
def read(
    file: _Path, *, unit: str = "", topic: str = "", tf_frame: str = "", tf_bodies: Sequence[str] = ...,
    salvage: bool = False, time_unit: str = ""
) -> _Recording:
    """Reads a recording of any format: 'markers' with positions (frames, markers, 3) in m, NaN where not seen, and
    'joints' with time_s (samples), positions (samples, joints), rad or m, and torques (samples, joints), N.m or N.
    unit: of lengths, where the file does not say it ('mm'). topic: of the joints, in a bag with several. tf_frame:
    the cameras' frame in the tf of a bag; tf_bodies: frames that are bodies, by default all that move in it.
    salvage: reads a bag that was not closed or was cut off, up to where it ends, which 'notes' then say. time_unit: of a
    joint log that does not state it ('ns'; by default s)."""
def info(
    file: _Path, *, unit: str = "", topic: str = "", tf_frame: str = "", tf_bodies: Sequence[str] = ...,
    salvage: bool = False, time_unit: str = ""
) -> dict[str, Any]:
    """What is in a recording or a posture table: the dict of `elastocal info --json`."""
def write_table(
    project: Union[Project, _Path],
    file: _Path,
    positions: ArrayLike,
    markers: ArrayLike,
    *,
    marker_names: Optional[Sequence[str]] = None,
) -> None:
    """Writes a table of static postures (CSV) that calibrate() and the program read. positions: (postures, joints),
    rad or m, by Project.joints. markers: (postures, markers, 3), m, NaN where not seen, by Project.markers unless
    `marker_names` names them. Columns have the project's names (`recording.columns` of docs/formats.md)."""
def design(
    project: Union[Project, _Path],
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
) -> Design:
    """Finds the smallest set of postures that tells most of the identifiable parameters, like the command of that
    name. count: exactly so many for each chain. elastic: compliances too. curves: also what other algorithms reach.
    progress: called with (done, total). Raises InfeasibleError where a chain has no such postures."""
def design_after(
    project: Union[Project, _Path],
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
) -> Design:
    """Chooses, like `elastocal design --after`, `count` postures of each chain that add most to a saved calibration
    or, with check=True, that tell best whether a joint (of `joints`, or any) has moved since (with contact or
    instruments, `count` in all). days: since the calibration. marker_noise_mm: of a coordinate, errors of the model
    included."""
def plan(
    project: Union[Project, _Path],
    postures: Optional[_Postures] = None,
    *,
    kind: Optional[str] = None,
    count: int = ...,
    move_s: float = ...,
    rest_s: float = ...,
    zmp_margin_mm: Optional[float] = None,
    lift_mm: Optional[float] = None,
    inset_mm: Optional[float] = None,
    approach_mm: Optional[float] = None,
    torque_share: Optional[float] = None,
    velocity_share: float = ...,
    balanced: bool = True,
    robots: int = 0,
    floor_friction: float = ...,
    leg_geometry_scale: float = ...,
    stabilised: bool = True,
    threads: int = ...,
    seed: int = 1,
    progress: _Progress = None,
) -> Plan:
    """Plans a motion through calibration postures that the robot does standing by itself, like the command of that
    name. postures: a Design, a posture file, or a dict of chains with arrays (postures, joints), rad or m, or lists
    of dicts of joints. kind: a validation motion instead, 'sine', 'random' (`count` postures a chain) or
    'repeatability'. robots: so many with errors try it. Arguments are those of the command, in the unit of their
    suffix, else SI. Raises InfeasibleError where there is no motion or it breaks a limit."""
def simulate(
    project: Union[Project, _Path],
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
) -> dict[str, Any]:
    """Simulates a calibration experiment on a robot with known errors into `folder`, like the command of that name,
    and returns the dict of `elastocal simulate --json` with 'warnings'. motion: a Plan, a file (CSV), or a dict
    with time_s (samples,), positions (samples, joints) and perhaps support (lists of links). postures: a Design, a
    file, or a dict of chains. settings: a file, or a dict of simulation_settings(). nominal: begins without
    imperfections. Progress counts trials."""
def export(
    calibration: _Path,
    format: str,
    file: _Path,
    *,
    project: _Path = "",
    prefix: str = "",
    mjcf: _Path = "",
    mjcf_joints: Sequence[str] = ...,
    mjcf_springs: bool = False,
    min_significance: float = 0.0,
    min_gain_mm: Optional[float] = None,
    beside_springs: bool = False,
    hip_damping: Optional[float] = None,
) -> list[str]:
    """Writes a saved calibration in a form that controllers and ROS read, like the command of that name: format
    'urdf', 'c99', 'mjcf' and so on (docs/deploy.md). Returns its notes: what stays nominal, and why. Other arguments
    are those of the command."""
class Compensation:
    """A planned motion that compensate() corrected."""

    @property
    def time_s(self) -> _Array:
        """(samples,), s."""
    @property
    def positions(self) -> _Array:
        """To command, (samples, joints), rad or m, by Project.joints."""
    @property
    def summary(self) -> dict[str, Any]:
        """The dict of `elastocal compensate --json`: largest correction, what is left, margins."""
    def save(self, file: _Path) -> None:
        """Writes the motion (CSV)."""
def compensate(
    calibration: _Path,
    motion: Union[Plan, _Path, _MotionDict],
    *,
    project: _Path = "",
    content: str = "everything",
    loads: str = "statics",
    most_left_mm: float = 5.0,
    most_turned_deg: float = 3.0,
) -> Compensation:
    """Corrects a planned motion so that hands, feet and waist go where the plan meant, like the command of that name.
    motion: a Plan, a file (CSV), or a dict of time_s, positions and perhaps support. content: 'everything', or
    'geometry' (without elasticity). loads: 'statics', or 'planned' for fast motion. Raises InfeasibleError where a
    limit would be broken, or more than most_left_mm is left at the end of a limb (a degree counts 5.2 mm, of an arm
    with too few joints 0.5 mm; its hand may be turned by most_turned_deg)."""
def batch(
    manifest: _Path, folder: _Path, *, workers: int = 0, level: float = 0.05, program: Optional[_Path] = None
) -> dict[str, Any]:
    """Does the tasks of a manifest (docs/scale.md) into a folder by the program's command of that name, which is looked
    for beside the module and on the path unless `program` names it: the dict of fleet.json. workers: tasks at a time;
    0: one a core. What is done is not done again."""
def simulation_settings() -> dict[str, dict[str, str]]:
    """What `settings` of simulate() may hold: by key, its 'default' and 'help'."""

class Runtime:
    """The calibrated robot in a controller. One thread at a time."""

    def __init__(
        self, calibration: _Path, project: _Path = "", content: str = "everything"
    ) -> None:
        """calibration: the folder that calibrate wrote. content: 'everything', 'geometry' (without elasticity) or
        'nominal'."""
    @property
    def joints(self) -> list[str]:
        """Joints that are entries of q, in its order."""
    @property
    def links(self) -> list[str]:
        """Names of all links."""
    @property
    def feet(self) -> list[str]:
        """Links of the feet, in the order of the bits of `feet`."""
    @property
    def status(self) -> str:
        """What the last call had to cut or replace, in words; also of q that is not finite, where the last good answer
        is given."""
    @property
    def residual_m(self) -> float:
        """What the last command leaves at the ends of the limbs, m."""
    @property
    def residual_rad(self) -> float:
        """What the last command leaves at the ends of the limbs, rad."""
    @property
    def stopped(self) -> list[str]:
        """Joints whose limit, or the limit of whose correction, keeps the end of a limb from its place after the last
        command."""
    @property
    def root_displacement(self) -> _Array:
        """Of the last correct: how far the root link is from that of the rigid robot on the same feet, (6,):
        translation in m, then rotation vector in rad, in the axes of the first foot that stands."""
    def forget(self) -> None:
        """Lets the next command be found by itself, and forgets the last input. Commands near the last one go on from
        it, as along a motion."""
    def start_from(self, command: _Positions) -> None:
        """Begins a motion from the command at which the drives are, q as in 'command': limit_changes holds from the
        next command on."""
    def limit_changes(self, most: ArrayLike) -> None:
        """Limits the change of a command from one call to the next, (joints,), rad or m: the largest speed times the
        time between calls. A joint that the plan moves further moves as far as the plan. Negative or NaN: no limit;
        empty: none at all."""
    def ease_changes(self, calls: float) -> None:
        """Lets a correction take so many calls to reach its largest speed, a tenth of that of limit_changes, and as
        many to brake. 0: corrections are given at once."""
    def forward(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> dict[str, Any]:
        """Poses (4, 4) in m of all 'links' in the root link's frame, with deflection, of the 'root', and the
        'status'. q: (joints,), rad or m, or a dict of joints, the others being at 0. torque: (all joints of the
        robot,), N.m, measured; empty: those of gravity. feet: bit i for foot i that stands."""
    def command(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> _Array:
        """Positions (joints,) to command so that hands and feet go where the nominal robot has them at q. q:
        (joints,), rad or m, or a dict of joints, the others being at 0. torque: (all joints of the robot,), N.m,
        measured; empty: those of gravity. feet: bit i for foot i that stands."""
    def correct(self, q: _Positions, torque: ArrayLike = ..., feet: int = 0) -> _Array:
        """Positions (joints,) at which a rigid calibrated robot has its hands where the real one has them (its URDF:
        `elastocal export --format urdf --beside-springs`). q: (joints,), rad or m, or a dict of joints, the others being at 0. torque: (all joints of the robot,), N.m,
        measured; empty: those of gravity. feet: bit i for foot i that stands."""
