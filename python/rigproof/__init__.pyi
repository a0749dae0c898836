"""Types of the package; help(rigproof.calibrate) and the like have the whole text."""
import os
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]
Progress = Optional[Callable[[int, int], Any]]
PoseLike = Union["Pose", Floats]

__version__: str

class Error(Exception):
    exit_code: int

class Pose:
    """A rigid transform T_target_source, metres."""
    def __init__(self, matrix: ArrayLike = ...) -> None: ...
    @staticmethod
    def from_quaternion(translation_m: ArrayLike, quaternion_xyzw: ArrayLike) -> Pose: ...
    @staticmethod
    def exp(xi: ArrayLike) -> Pose: ...
    def log(self) -> Floats: ...
    def inverse(self) -> Pose: ...
    @overload
    def __matmul__(self, other: Pose) -> Pose: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> Floats: ...
    @property
    def matrix(self) -> Floats:
        """(4, 4)"""
    @property
    def rotation(self) -> Floats:
        """(3, 3)"""
    @property
    def translation_m(self) -> Floats:
        """(3,)"""
    @property
    def quaternion_xyzw(self) -> Floats:
        """(4,)"""

class Camera:
    """Intrinsics, as OpenCV has them; the centre of the top-left pixel is (0, 0)."""
    def __init__(self, width_px: int, height_px: int, fx_px: float, fy_px: float, cx_px: float, cy_px: float,
                 lens: str = "pinhole", distortion: Sequence[float] = ()) -> None: ...
    @overload
    def project(self, points_camera_m: ArrayLike) -> Floats:
        """Pixels (n, 2) of points (n, 3); NaN where there is none."""
    @overload
    def project(self, points_camera_m: ArrayLike, jacobians: bool) -> Tuple[Floats, Floats]:
        """Also the derivatives (n, 2, 3) by the points."""
    def unproject(self, pixels: ArrayLike) -> Floats:
        """Rays (n, 3) with z = 1 of pixels (n, 2)."""
    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    lens: str
    distortion: List[float]
    @property
    def matrix(self) -> Floats:
        """K (3, 3)"""

class Board:
    type: str
    squares_x: int
    squares_y: int
    square_m: float
    @property
    def corners_m(self) -> Floats:
        """(n, 3) in the board frame, by id."""
    @property
    def place(self) -> Optional[Dict[str, Any]]:
        """Of one of more_boards: T_first_board, sigma_m, sigma_rad."""

class Finding:
    """str() says it in words."""
    code: str
    severity: str
    cameras: List[str]
    axes: List[str]
    stops: List[int]
    values: Dict[str, Union[float, str]]
    because: List[Finding]

class Exclusion:
    camera: int
    stop: int
    file: str
    depth: bool
    why: Finding

class RigCamera:
    name: str
    sensor: str
    link: str
    folder: str
    camera: Camera
    has_depth: bool

class CameraFrame:
    color_file: str
    depth_file: str
    cloud_file: str
    stamp_s: float
    exposure_s: float

class Recording:
    @staticmethod
    def load(folder: Path) -> Recording: ...
    folder: os.PathLike[str]
    robot_frame: str
    board: Board
    more_boards: List[Board]
    cameras: List[RigCamera]
    frames: Dict[str, List[CameraFrame]]
    @property
    def odometry(self) -> Floats:
        """(n, 4): stamp_s, x_m, y_m, yaw_rad, of the point about which the robot turns"""

class BoardView:
    def __init__(self, stop: int, camera: int, stamp_s: float, ids: Sequence[int], pixels: ArrayLike,
                 covariances_px2: Optional[ArrayLike] = None, file: str = "", board: int = 0) -> None: ...
    stop: int
    camera: int
    stamp_s: float
    file: str
    board: int
    @property
    def ids(self) -> NDArray[np.int32]:
        """(n,)"""
    @property
    def pixels(self) -> Floats:
        """(n, 2)"""
    @property
    def covariances_px2(self) -> Floats:
        """(n, 2, 2)"""

class PlaneObservation:
    stop: int
    camera: int
    file: str
    effective_points: float
    residual_rms_sigma: float
    @property
    def inverse_depth_plane_per_m(self) -> Floats:
        """a (3,) of {p : a . p = 1} in the colour camera's frame"""
    @property
    def covariance_per_m2(self) -> Floats:
        """(3, 3)"""

class Observations:
    @staticmethod
    def load(file: Path) -> Observations: ...
    @staticmethod
    def from_json(text: str) -> Observations: ...
    def to_json(self) -> str: ...
    def save(self, file: Path) -> None: ...
    source: str
    robot_frame: str
    board: Board
    more_boards: List[Board]
    cameras: List[RigCamera]
    board_views: List[BoardView]
    ground_planes: List[PlaneObservation]
    board_planes: List[PlaneObservation]
    exclusions: List[Exclusion]
    @property
    def stamps_s(self) -> Floats:
        """(stops,)"""
    @property
    def odometry(self) -> Floats:
        """(stops, 3): x_m, y_m, yaw_rad"""
    @property
    def velocities(self) -> Floats:
        """(stops, 3): m/s, m/s, rad/s in the robot's frame"""
    @property
    def accelerations(self) -> Floats:
        """(stops, 3): m/s^2, m/s^2, rad/s^2, how the velocities change"""

class TrueCamera:
    name: str
    T_robot_camera: Pose
    camera: Camera
    depth_scale: Optional[float]
    sensing: Dict[str, float]

class Truth:
    @staticmethod
    def load(file: Path) -> Truth: ...
    def save(self, file: Path) -> None: ...
    scene: str
    seed: int
    board: Board
    cameras: List[TrueCamera]
    poses: Dict[str, Pose]
    T_world_board: Pose
    more_boards: List[Dict[str, Any]]
    T_world_robot: List[Pose]
    stamps_s: Floats
    drawn: Dict[str, float]

class EstimatedTransform:
    parent: str
    child: str
    T_parent_child: Pose
    covariance: Optional[Floats]
    sigma: Optional[Floats]
    observable: NDArray[np.bool_]
    budget: Dict[str, Floats]

class Result:
    def __init__(self, method: str, poses: Dict[str, PoseLike], robot_frame: str = "base_footprint",
                 covariances: Dict[str, ArrayLike] = ...) -> None: ...
    @staticmethod
    def refused(method: str, reason: str) -> Result: ...
    @staticmethod
    def load(file: Path) -> Result: ...
    def save(self, file: Path) -> None: ...
    method: str
    status: str
    reasons: List[Finding]
    notes: List[Finding]
    poses: Dict[str, Pose]
    camera_to_robot: List[EstimatedTransform]
    camera_to_camera: List[EstimatedTransform]
    joint_covariance: Optional[Floats]
    use: Dict[str, Dict[str, Any]]
    residuals: List[Dict[str, Any]]
    also_estimated: List[Dict[str, Any]]
    lenses: Dict[str, Camera]
    boards: List[Dict[str, Any]]
    rotation_centre_m: Floats
    rotation_centre_sigma_m: Optional[float]
    solve_s: float

class TransformError:
    parent: str
    child: str
    name: str
    between_cameras: bool
    error: Floats
    sigma: Optional[Floats]
    z: Floats
    observable: NDArray[np.bool_]
    T_estimate: Pose
    T_true: Pose

class Check:
    name: str
    passed: bool
    value: float
    limit: float
    unit: str

class Validation:
    """str() is what `rigproof validate` prints."""
    passed: bool
    checks: List[Check]
    camera_to_robot: List[TransformError]
    camera_to_camera: List[TransformError]
    missing_cameras: List[str]
    nees: Optional[float]
    nees_degrees_of_freedom: int
    suspicion: str

class Input:
    path: os.PathLike[str]
    format: str
    recording: Optional[Recording]
    observations: Optional[Observations]
    truth: Optional[Truth]
    results: Dict[str, Result]

class ViewPose:
    view: int
    stop: int
    camera: int
    T_camera_board: Pose
    covariance: Floats
    reprojection_rms_px: float
    board: int

Data = Union[Observations, Input, Path]
Method = Union[str, Callable[[Observations], Union[Result, Dict[str, PoseLike]]]]

def open(path: Path) -> Input: ...
def observe(data: Data, threads: int = 0, progress: Progress = None) -> Observations: ...
def calibrate(data: Data, method: Method = "ml", threads: int = 0, progress: Progress = None) -> Result: ...
def validate(result: Result, truth: Truth, budget: Optional[str] = None) -> Validation: ...
def bound(observations: Observations, truth: Truth) -> List[Dict[str, Any]]: ...
def view_poses(observations: Observations) -> List[ViewPose]: ...
def draw(seed: int = 0, stops: int = 100, corner_sigma_px: float = 0.1,
         odometry_lambda: float = 1.0) -> Tuple[Observations, Truth]: ...
def generate(config: str, output: Path, set: Sequence[str] = (), jobs: int = 0, cache: Path = "", fresh: bool = False,
             progress: Progress = None) -> Dict[str, Any]: ...
def sense(source: Path, output: Path, cache: Path, set: Sequence[str] = (), jobs: int = 0,
          progress: Progress = None) -> Dict[str, Any]: ...
def sweep(config: str, folder: Path, methods: Sequence[Method] = (), set: Sequence[str] = (), jobs: int = 0,
          cache: Path = "", redo: Sequence[str] = (), progress: Progress = None) -> Dict[str, Any]: ...
def sweep_rows(folder: Path) -> Dict[str, Any]: ...
def methods() -> List[Dict[str, str]]: ...
def data_folder() -> os.PathLike[str]: ...
def transform_error(T_estimate: PoseLike, T_true: PoseLike) -> Floats: ...
def apply_transform_error(T: PoseLike, error: ArrayLike) -> Pose: ...
def nees(estimates: Sequence[PoseLike], truths: Sequence[PoseLike], covariance: ArrayLike) -> Optional[float]: ...
