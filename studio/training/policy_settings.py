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
from studio.training.retargeted import with_people

Preset = Literal["default", "paper"]
PolicyName = Literal["stand", "walk", "sit", "all"]
"""An expert's state, or "all": one monolithic policy of every state."""
BANKS = Path("runs/banks")


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """What one expert is trained with unless told otherwise.

    distil: samples learnt from the teacher before PPO. Sitting, the teacher itself falls on slopes
    (success .88 against .99 of PPO's policy): it has no sense of balance, and four feet need none.
    heading_gain, place_gain: 1/s, and heading_smooth: s, see `observation.History`; who sits turns
    by 3.5 degrees, which is less than the reference's noise. Nobody holds its place, and a walk's
    heading steers only as its mean over a second: both excited the gait until the robot fell
    (`evaluate endurance`). init_heading, steep: see EnvConfig.
    anchor_tau, anchor_yaw_tau: s, see EnvConfig: walking at 0.5 s, a speed that is 0.08 m/s short
    costs 3 % of the reward, at 3 s 68 %; sitting at 0.5 s, nothing asks for a trunk that stays
    turned. noise_low: rad, least σ of the reference noise: a
    policy that has only met noise reads small tilts as noise. root_ori: scale of that reward term.
    unrest: how much of a motion that went before
    the trunk may still have at the start, as a share of a walk's: a robot that sits down stood.
    mirror_loss: see PpoConfig; the weights then run symmetric (`policy.Symmetric`), or a robot
    that is asked to walk straight turns by some degrees a second.
    """

    distil: int = 800_000
    heading_gain: float = 0.0
    heading_smooth: float = 0.0
    init_heading: float = 0.3
    steep: float = 0.0
    place_gain: float = 0.0
    anchor_tau: float = 0.5
    anchor_yaw_tau: float = 0.5
    noise_low: float = 0.0
    root_ori: float = 5.0
    unrest: float = 1.0
    mirror_loss: float = 1.0


RECIPES: dict[PolicyName, Recipe] = {
    "stand": Recipe(),
    "walk": Recipe(heading_gain=0.6, heading_smooth=1.0, anchor_tau=3.0, anchor_yaw_tau=5.0),
    "sit": Recipe(
        distil=0,
        heading_gain=1.0,
        init_heading=0.05,
        anchor_yaw_tau=10.0,
        root_ori=80.0,
        unrest=0.3,
        steep=0.4,
    ),
    "all": Recipe(),
}


@dataclass(frozen=True, kw_only=True)
class PolicyTraining:
    """`a1-studio train policy`.

    state: which expert, or "all" for one monolithic policy. preset: "paper" for the paper's PPO.
    samples: control steps in all, over every environment and every resumed part; hours: stop
    earlier, after so long. threads: of physics and learner, 0 for every core (beside other busy
    programs fewer are faster: they wait for each other). device: where the networks learn, by
    torch's name (cpu, cuda, cuda:1, mps); the physics stays on the processor. A checkpoint goes on
    on any device.

    run: folder of checkpoint, curve and TensorBoard files (default runs/policy-STATE, or
    runs/teacher-STATE for a teacher). resume: go on from the run's checkpoint, or from
    `checkpoint`, and `explore`: with actions spread by so much, in units of action, None for the
    checkpoint's own (what is told apart by less than the spread is learnt slowly). publish: write
    the weights to models/policy/STATE.safetensors too (always to the run's folder).

    curriculum, randomise, yaw_rate, action, future: what the ablations switch; future: give the
    policy its true reference 0.1, 0.2 and 0.3 s ahead. gate, patience: see Curriculum.
    crossings: motions out of each other state a difficulty, 0 for none. people: whose motions,
    as the mapper retargets them, join the library's for walking and sitting. push: m/s, the largest
    kick (EnvConfig). clean: share of the episodes whose reference has no noise.

    recipe: of the state, None for its own. distil: samples learnt from a teacher before PPO, None
    for the recipe's (the paper's preset has none). teacher: whose, the teacher.safetensors of a run
    with `privileged`, which trains one on clean references and the simulation's own state; None for
    the analytic one. warmup: iterations in which only the critic learns, so that PPO does not spoil
    what was taught.
    """

    state: PolicyName
    preset: Preset = "default"
    samples: int = 30_000_000
    hours: float = 100.0
    num_envs: int = 256
    threads: int = 0
    device: str = "cpu"
    seed: int = 0
    run: Path | None = None
    resume: bool = False
    checkpoint: Path | None = None
    publish: bool = False
    curriculum: bool = True
    randomise: bool = True
    yaw_rate: bool = True
    action: ActionMode = "residual"
    future: bool = False
    crossings: int = 24
    people: int = 12
    motions_per_task: int = 40
    gate: float = 0.75
    patience: int = 800
    push: float = 0.4
    distil: int | None = None
    recipe: Recipe | None = None
    warmup: int = 10
    privileged: bool = False
    teacher: Path | None = None
    clean: float = 0.0
    explore: float | None = None
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
        if self.teacher and not self.lessons:
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
        return self.made_by.distil if self.preset == "default" else 0

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
            crossings=config.crossings,
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
        place_gain=recipe.place_gain if config.yaw_rate else 0.0,
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
        init_first=0.3 if config.crossings else 0.0,
        init_speed=0.6 * recipe.unrest if config.crossings else 0.0,
        init_spin=1.0 * recipe.unrest if config.crossings else 0.0,
        init_heading=recipe.init_heading if observation.heading_gain else 0.0,
        init_place=0.2 if observation.place_gain else 0.0,
        push=config.push,
        steep=recipe.steep,
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
