"""The settings of `a1-studio train policy` → bank, environment and algorithm of a run."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, get_args

from studio.control.action import ActionConfig, ActionMode
from studio.control.observation import ObservationConfig
from studio.errors import StudioError, unknown_name
from studio.reference.intent import STATES, StateName
from studio.rl.bank import MotionBank, merged
from studio.rl.bank_store import library_bank
from studio.rl.curriculum import Curriculum, stages
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.noise import NoiseConfig
from studio.rl.privileged import PrivilegedEnv
from studio.rl.reward import RewardConfig
from studio.training.device import check_device
from studio.training.ppo import PAPER, PpoConfig
from studio.training.recipes import (
    BEGUN_FIRST,
    RECIPES,
    TAUGHT,
    UNREST_SPEED,
    UNREST_SPIN,
    PolicyName,
    Recipe,
)
from studio.training.retargeted import with_people
from studio.training.usual import Usual, UsualInt

Preset = Literal["default", "paper"]
BANKS = Path("runs/banks")


@dataclass(frozen=True, kw_only=True)
class PolicyTraining:
    """`a1-studio train policy`.

    state: which expert, or "all" for one monolithic policy. A default that is a `Usual`, and None,
    gives way to what the stages of a shipped policy have (`stages`: sitting trains a teacher
    first); what is given never does. preset: "paper" for the paper's PPO. samples: control steps of
    each stage, over every environment and every resumed part; hours: stop earlier, after so long in
    all. threads: of physics and learner, 0 for every core (beside other busy programs fewer are
    faster: they wait for each other). device: where the networks learn, by torch's name (cpu, cuda,
    cuda:1, mps); the physics stays on the processor. A checkpoint goes on on any device.

    run: folder of checkpoint, curve and TensorBoard files (default runs/policy-STATE, or
    runs/teacher-STATE for a teacher). resume: go on where the run's stages stopped; checkpoint: go
    on from this one, and `explore`: with actions spread by so much, in units of action, None for
    the checkpoint's own (what is told apart by less than the spread is learnt slowly). publish:
    copy what was made to models/policy too (always to the run's folder). average: a policy's
    weights; what is kept beside the checkpoint is the mean of them and of what was learnt.

    curriculum, randomise, yaw_rate, action, future: what the ablations switch; future: give the
    policy its true reference 0.1, 0.2 and 0.3 s ahead. gate, patience: see Curriculum.
    transitions: motions out of each other state a difficulty, 0 for none. people: whose motions,
    as the mapper retargets them, join the library's for walking and sitting. push: m/s, the largest
    kick (EnvConfig). clean: share of the episodes whose reference has no noise.

    variant: a second policy of the ablation (`variants`): a plain recipe with one change, published
    to models/policy/ablation.

    recipe: of the state, None for its own. distil: samples learnt from a teacher before PPO, None
    for those of TAUGHT (the paper's preset has none). teacher: whose, the teacher.safetensors of a
    run with `privileged`, which trains one on clean references and the simulation's own state; None
    for the analytic one. warmup: iterations in which only the critic learns, so that PPO does not
    spoil what was taught.
    """

    state: PolicyName
    preset: Preset = "default"
    samples: int = UsualInt(30_000_000)
    hours: float = 100.0
    num_envs: int = 256
    threads: int = 0
    device: str = "cpu"
    seed: int = 0
    run: Path | None = None
    resume: bool = False
    checkpoint: Path | None = None
    publish: bool = False
    variant: str | None = None
    curriculum: bool = True
    randomise: bool = True
    yaw_rate: bool = True
    action: ActionMode = "residual"
    future: bool = False
    transitions: int = UsualInt(24)
    people: int = UsualInt(12)
    motions_per_task: int = 40
    gate: float = Curriculum.gate
    patience: int = Curriculum.patience
    push: float = Usual(EnvConfig.push)
    distil: int | None = None
    recipe: Recipe | None = None
    warmup: int = UsualInt(10)
    privileged: bool = False
    teacher: Path | None = None
    clean: float = Usual(0.0)
    explore: float | None = None
    average: Path | None = None
    checkpoint_seconds: float = 60.0
    ppo: PpoConfig = field(default_factory=PpoConfig)

    def __post_init__(self) -> None:
        if self.state not in get_args(PolicyName):
            raise unknown_name("state", self.state, get_args(PolicyName))
        if self.num_envs < 2 or self.samples < 1:
            raise StudioError("train policy needs --num-envs of at least 2 and positive --samples")
        check_device(self.device)
        if self.privileged and self.publish:
            raise StudioError("a privileged teacher cannot run on a robot: leave --publish off")
        if self.teacher and self.privileged:
            raise StudioError("a teacher is not taught: leave out --teacher or --privileged")
        if self.teacher and self.distil == 0:
            raise StudioError("--teacher teaches for --distil samples: give them")

    @property
    def made_by(self) -> Recipe:
        """The recipe in force."""
        return self.recipe or RECIPES[self.state]

    @property
    def lessons(self) -> int:
        """Samples learnt from the teacher, 0 for none."""
        if self.privileged:
            return 0
        if self.distil is not None:
            return self.distil
        return TAUGHT[self.state] if self.preset == "default" else 0

    @property
    def level(self) -> StateName:
        """The state about whose neutral trunk tilt is measured."""
        return "stand" if self.state == "all" else self.state

    @property
    def folder(self) -> Path:
        """The run's folder."""
        kind = "teacher" if self.privileged else "policy"
        return self.run or Path("runs") / f"{kind}-{self.state}"


FUTURE_PERIODS = (3, 6, 9)


def make_bank(config: PolicyTraining, cache: Path | None = BANKS) -> MotionBank:
    """The motions of a run."""
    states = STATES if config.state == "all" else (config.state,)
    banks = [
        library_bank(
            cache,
            state,
            per_task=config.motions_per_task,
            seed=config.seed,
            transitions=config.transitions,
            travels=config.made_by.travels * config.motions_per_task,
        )
        for state in states
    ]
    if len(banks) > 1:
        return merged(banks, config.level)
    return with_people(banks[0], config.people, config.seed, cache)


def make_environment(
    config: PolicyTraining, cache: Path | None = BANKS, seed: int | None = None
) -> ImitationEnv:
    """Bank, curriculum and environment of a run; seed: of what is drawn in it, None: the run's."""
    bank, recipe = make_bank(config, cache), config.made_by
    ladder = stages(bank.tasks)
    if not config.randomise:
        ladder = [s for s in ladder if s.randomisation == 0.0]
    curriculum = Curriculum(ladder=ladder, gate=config.gate, patience=config.patience)
    if not config.curriculum:
        curriculum.finish()
    noise = NoiseConfig()
    low_high = (recipe.noise_low, noise.joint_sigma[1])
    noise = replace(noise, joint_sigma=low_high, clean=config.clean)
    observation = ObservationConfig(
        yaw_rate=config.yaw_rate,
        heading_gain=recipe.heading_gain if config.yaw_rate else 0.0,
        heading_smooth=recipe.heading_smooth,
        future=FUTURE_PERIODS if config.future else (),
    )
    settings = EnvConfig(
        num_envs=config.num_envs,
        threads=config.threads,
        observation=observation,
        action=ActionConfig(mode=config.action),
        reward=RewardConfig(root_ori=recipe.root_ori),
        noise=noise,
        anchor_tau=recipe.anchor_tau,
        anchor_yaw_tau=recipe.anchor_yaw_tau,
        init_first=BEGUN_FIRST if config.transitions else 0.0,
        init_speed=UNREST_SPEED * recipe.unrest if config.transitions else 0.0,
        init_spin=UNREST_SPIN * recipe.unrest if config.transitions else 0.0,
        init_heading=recipe.init_heading if observation.heading_gain else 0.0,
        push=config.push,
        steep=recipe.steep,
        motors=recipe.motors,
    )
    seed = config.seed if seed is None else seed
    if config.privileged:
        settings = replace(settings, noise_scale=0.0)
        return PrivilegedEnv(settings, bank, seed=seed, curriculum=curriculum)
    return ImitationEnv(settings, bank, seed=seed, curriculum=curriculum)


def algorithm_of(config: PolicyTraining) -> PpoConfig:
    """PPO's figures of a run."""
    ppo = PAPER if config.preset == "paper" else config.ppo
    if config.privileged:  # its mirror image is nobody's to deploy
        return replace(ppo, mirror=False, mirror_loss=0.0)
    if config.lessons:
        # Lessons are mirrored already. With a taught policy's small spread, PPO's ratio of a
        # mirrored sample (old probability of the original) is far from 1 however symmetric
        # the policy nearly is: reward then falls while PPO believes it rises (measured).
        ppo = replace(ppo, mirror=False, mirror_loss=config.made_by.mirror_loss)
    return ppo
