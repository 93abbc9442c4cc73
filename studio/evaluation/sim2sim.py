"""The exported policies in a second engine: PyBullet's own A1, which nobody trained on.

Each is written as ONNX, read again by what the file says of itself (by
`models/policy/onnx_runner.py`), and tracks the same references through the robot's side of a link;
MuJoCo's robot beside it.
"""

import importlib.util
import logging
import tempfile
from dataclasses import asdict, dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import metrics
from studio.control.controllers import Controller, ControllerInput, PdPlayback
from studio.control.observation_frame import one_reference_frame, one_sensor_frame
from studio.control.policy import MODELS
from studio.errors import StudioError
from studio.evaluation.link import PeopleOptions, Run, runs_of, toured
from studio.evaluation.tracking import CACHE
from studio.geometry import scalars
from studio.link.engine import Engine, MujocoEngine
from studio.link.pybullet_engine import PybulletEngine
from studio.link.robot_policy import RobotPolicy
from studio.link.simulated import Line, SimulatedLink
from studio.options import EngineName
from studio.reference.intent import STATES
from studio.synthetic.operator import OperatorSource
from studio.training.export import export_onnx
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]
TASKS = ("tilt", "crouch", "manipulate_right", "walk", "turn", "sit_tilt", "sit_manipulate")
ENGINES: tuple[EngineName, ...] = ("mujoco", "pybullet")
CONTROLLERS = ("policy", "pd_playback")
_FLOW = (
    "control", "human", "link", "mocap", "reference", "retarget", "robot", "scenes", "sim",
    "synthetic", "geometry", "rhythm", "timing", "metrics", "puppeteer", "training/export",
    "evaluation/behind", "evaluation/link", "evaluation/sim2sim",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row. task: of the synthetic person. controller: "policy", the exported ones, or
    "pd_playback"."""

    task: str
    engine: EngineName
    controller: str


@dataclass(frozen=True, kw_only=True)
class Options(PeopleOptions):
    """Of `evaluate sim2sim`."""

    seconds: float = 20.0
    """How long each drives."""


class ExportedPolicies(Controller):
    """The shipped policies as files for other machines, each by its manifest alone: targets for a
    PD, filtered and limited already. Remembers their histories. One thread."""

    name = "policy"

    def __init__(self) -> None:
        runner = _runner()
        with tempfile.TemporaryDirectory() as folder:
            self._runners = {
                state: runner(str(export_onnx(state, Path(folder) / f"{state}.onnx")))
                for state in STATES
            }
        self._state: str | None = None

    def reset(self, now: ControllerInput) -> None:
        """As a controller's."""
        self._state = now.state
        self._runners[now.state].reset(*self._frames(now))

    def act(self, now: ControllerInput) -> Array:
        """(12,) rad for the motors."""
        runner = self._runners[now.state]
        if now.in_transition and not runner.manifest.get("transitions", False):
            self._state = None
            return now.reference.joint_pos
        if now.state != self._state:
            self.reset(now)
        return np.asarray(runner.step(*self._frames(now)), dtype=np.float64)

    def _frames(self, now: ControllerInput) -> tuple[Array, Array]:
        level = scalars.rows(self._runners[now.state].manifest["level_quat"])
        return one_sensor_frame(now.robot, level, True), one_reference_frame(now.reference, level)


@cache
def _runner() -> Any:
    """The class of `models/policy/onnx_runner.py`, as whoever copies that file would load it."""
    spec = importlib.util.spec_from_file_location("onnx_runner", MODELS / "onnx_runner.py")
    if spec is None or spec.loader is None:
        raise StudioError(f"{MODELS / 'onnx_runner.py'} is missing")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Runner


def run_sim2sim(options: Options = Options(), *, cache: Path | None = CACHE) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per task, engine and controller. Where PyBullet is not installed,
    MuJoCo's rows alone."""
    engines = ENGINES if find_spec("pybullet") else ENGINES[:1]
    if engines != ENGINES:
        log.warning("no second engine: pip install 'a1-studio[pybullet]'")
    cases = [
        Case(task=task, engine=engine, controller=controller)
        for task in TASKS
        for engine in engines
        for controller in CONTROLLERS
    ]
    made = runs_of("sim2sim", _FLOW, track, cases, options, cache)
    return {"rows": [row(case, runs, options) for case, runs in made]}


def track(case: Case, seconds: float, seed: int) -> Run:
    """One person, drawn from `seed`, does the task; the robot of the case's engine tracks it."""
    engine: Engine = PybulletEngine() if case.engine == "pybullet" else MujocoEngine()
    try:
        exported = case.controller == "policy"
        controller = ExportedPolicies() if exported else PdPlayback()
        policy = RobotPolicy(controller, filters=not exported)
        link = SimulatedLink(Line(), "references", seed, policy=policy, engine=engine)
        return toured(link, OperatorSource(case.task, seed=seed), seconds, seed)
    finally:
        engine.close()


def row(case: Case, runs: list[Run], options: Options) -> dict[str, Any]:
    """Means over people; errors against the reference that was sent `lag_ms` before."""
    survived = [1.0 if not r.fell else r.seconds / options.seconds for r in runs]
    return {
        "case": f"{case.task}, {case.engine}",
        **asdict(case),
        "seed": options.seed,
        "episodes": len(runs),
        "commit": commit(),
        "falls": sum(run.fell for run in runs),
        "success_time_ratio": float(np.mean(survived)),
        "joint_rmse_deg": metrics.rms_deg(float(np.mean([run.joint_ms for run in runs]))),
        "orientation_error_deg": float(np.degrees(np.mean([run.tilt for run in runs]))),
    }
