"""THE FLOW ON ONE PAGE: a HumanPose in, one control period of the robot out, as a Tick.

    source = open_source("bvh:march.bvh")
    puppeteer = Puppeteer(calibration=calibrate(source.calibration_poses()))
    for pose in poses(source):
        tick = puppeteer.step(pose)

Live is this plus a clock (`live.loop`); a headless drive and every table are this without one.
"""

from collections.abc import Callable
from dataclasses import replace

from studio.control.controllers import ControllerInput, open_controller
from studio.control.drive_command import FOLLOW, Directive, DriveCommand, PuppeteerConfig, Reason
from studio.control.floor_slope import FloorSlope
from studio.control.staleness import STALE_AFTER, STAND_AFTER, why_still
from studio.control.state_machine import Decision, StateMachine
from studio.errors import unknown_name
from studio.human.calibration import Calibration
from studio.human.pose import HumanPose
from studio.link.link import Order, RobotLink
from studio.mocap.human_tracker import HumanTracker
from studio.options import Steps, Travel
from studio.reference.intent import STATES, StateName
from studio.retarget.retargeter import Retargeted, Retargeter
from studio.retarget.section_times import SectionTimes
from studio.retarget.settings import LIMITS
from studio.retarget.store import Experts
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotState
from studio.scenes.stage import Place, Stage
from studio.sim.actuation import MotorTargets
from studio.takes.tick import Tick

FIRST_VOTE = 1.0
"""s to wait for the first vote that is not "unknown" before the robot starts standing."""


class Puppeteer:
    """Person in, robot out. Remembers all there is to remember; one thread only."""

    def __init__(
        self,
        config: PuppeteerConfig | None = None,
        calibration: Calibration | None = None,
        retargeter: Retargeter | None = None,
        link: RobotLink | None = None,
    ) -> None:
        """link: None for a simulated robot. StudioError for unknown names or untrained experts."""
        self.config = c = config or PuppeteerConfig()
        self.retargeter = retargeter or Retargeter.load(
            c.style, calibration, mirror=c.mirror, travel=c.travel, steps=c.steps
        )
        self.state_machine, self.controller = StateMachine(), open_controller(c.controller)
        self.motors, self.stage = MotorTargets(), Stage(c.scene, c.seed, link)
        self.link = self.stage.link
        self.lock_state(c.state)
        for name in LIMITS:
            self.set_gain(name, getattr(c, name))
        self.reset()

    def step(
        self,
        human: HumanPose | None = None,
        command: DriveCommand | Callable[[float], DriveCommand] = FOLLOW,
        shown: tuple[StateName, ReferencePose] | None = None,
    ) -> Tick:
        """One control period (1/30 s). None: nothing new was seen. Never fails on a bad pose.

        command: what whoever keeps watch asks for, or makes of the age of the last pose that was
        believed (s, inf before the first). shown: a motion that the robot does in place of theirs.
        """
        times = SectionTimes()
        fresh = self.person.see(human)
        command = command(self.person.age) if callable(command) else command
        command, self.robot = self.link.advise(command), self.link.sense()
        slope = self.floor.see(self.state_machine, self.robot)
        self.state_machine.slope = self.retargeter.planner.slope = slope
        with times("retarget"):
            mapped = self.retargeter.step(self.person.now, watch=not self._go_on_from_here())
        self._placed |= shown is not None
        if not self._placed:
            self._place_at_first_vote(mapped, command)
        with times("controller"):
            wanted: StateName = self.lock or mapped.active  # type: ignore[assignment]
            reference = mapped.reference if mapped.active == wanted else None
            if shown is not None:
                wanted, reference = shown
            decision = self.state_machine.step(wanted, reference, command.directive, command.ramp)
        with times("policy"):
            action = self.controller.act(now := self._controller_input(decision))
        with times("filter"):
            target = self.motors.step(action)
        with times("physics"):
            self.robot = self.stage.step(Order(target=target, asked=now, damping=command.damping))
        clipped = mapped.clipped and self.state_machine.following
        self.reason, why = command.reason, command.why
        if not why and shown is None:
            self.reason, why = why_still(self.person.age, mapped.expert, mapped.votes, self.lock)
        self.retargeted, self._index = mapped, self._index + 1
        self._clipped += clipped
        inference = sum(ms for section, ms in times.items() if section != "physics")
        if not command.damping and not self.fallen:
            self.fallen = self.stage.fallen(decision.reference)
        return Tick(
            index=self._index - 1,
            t=self.person.t,
            human=self.person.last,
            human_fresh=fresh,
            expert=mapped.expert,
            votes=mapped.votes,
            state=decision.state,
            transition_to=decision.transition_to,
            mode=command.mode,
            controller=self.controller.name,
            reference=decision.reference if shown is None else shown[1],
            action=action,
            target=self.link.target,
            robot=self.robot,
            clipped=clipped,
            fallen=self.fallen,
            why=why,
            timings_ms={**mapped.timings_ms, **times, "inference": inference},
            counters=self.counters,
        )

    def reset(self) -> None:
        """Forget the person; the robot stands at the origin and starts in the first voted state."""
        self.retargeter.reset()
        self.person = HumanTracker(reuse=STAND_AFTER, stale=STALE_AFTER)
        self.reason: Reason = ""
        self.retargeted: Retargeted | None = None
        self._index, self._waited, self._clipped = 0, 0.0, 0
        self._placed = not self.link.poses  # any other robot begins as it stands
        self.place("stand")

    def forget_person(self, calibration: Calibration | None = None) -> None:
        """Another person, or another source, from here on; the robot stays as it is."""
        if calibration is not None:
            self.retargeter = self.retargeter.for_person(calibration)
        self.retargeter.reset()
        self.person.forget()
        self.rejoin()

    def rejoin(self) -> None:
        """Ease into the person's motion anew, from wherever the robot is."""
        self.state_machine.rejoin()

    def align_robot_to_reference(self) -> None:
        """The robot goes on where its reference is and faces, if nothing is in its way."""
        self.robot = self.stage.move_robot(self.state_machine.reference)

    def place(self, state: StateName, *, here: bool = False) -> None:
        """At rest in the neutral pose of `state`, where the scene begins or where the robot is."""
        at = self.stage.restart_at(self.robot) if here else self.stage.start
        self.state_machine.reset(state, *at)
        self._restart()

    def stand_up(self, at: Place | None = None) -> None:
        """After a fall or a stop, 1 s from a crouch: `at`, where it is, or where a scene begins."""
        self.link.rise()
        if self.link.poses:  # any other robot rises by itself
            self.state_machine.crouch(*(at or self.stage.restart_at(self.robot)))
            self._restart()
        self._placed, self.fallen = True, False

    def _restart(self) -> None:
        self.robot: RobotState = self.stage.reset(self.state_machine.reference)
        self.motors.reset(self.state_machine.reference.joint_pos)
        self.controller.reset(self._controller_input())
        self.floor, self.fallen = FloorSlope(), False

    def lock_state(self, state: str) -> None:
        """Stay in `state`; "auto" lets the selector decide. StudioError for anything else."""
        if state != "auto" and state not in STATES:
            raise unknown_name("state", state, ("auto", *STATES))
        self.lock: StateName | None = None if state == "auto" else state  # type: ignore[assignment]
        self.retargeter.set_expert(self.lock)

    def set_gain(self, name: str, value: float) -> None:
        """A slider: a name of LIMITS and a value within its range. StudioError otherwise."""
        self.retargeter.settings = new = self.retargeter.settings.with_gain(name, value)
        self.state_machine.joint_speed = new.joint_speed

    @property
    def counters(self) -> dict[str, int]:
        """Totals since the last reset."""
        return {**self.person.counters, "clipped": self._clipped, "late": 0}

    def set_mirror(self, mirror: bool) -> None:
        """Mirror the person from the next pose on."""
        self.config = replace(self.config, mirror=mirror)
        self.retargeter.extractor.mirror = mirror

    def set_walk(self, *, travel: Travel | None = None, steps: Steps | None = None) -> None:
        """Beside a person or on the spot, and in whose steps; None: as before."""
        c = self.config
        self.config = c = replace(c, travel=travel or c.travel, steps=steps or c.steps)
        self.retargeter.travel, self.retargeter.steps = c.travel, c.steps
        self.set_experts(self.retargeter.experts)

    def set_experts(self, experts: Experts) -> None:
        """Map the person by other experts from the next period on; what was seen is kept."""
        self.retargeter.use(experts)
        self.config = replace(self.config, style=experts.style)
        self.rejoin()

    def set_stage(self, stage: Stage) -> None:
        """Another scene, from its beginning; the robot stands up in it."""
        self.stage, self.link = stage, stage.link
        self.config = replace(self.config, scene=stage.name)
        self.place("stand")
        self.rejoin()

    def set_controller(self, name: str) -> None:
        """Another controller from the next period on. StudioError if there is none of the name."""
        self.controller = open_controller(name)
        self.controller.reset(self._controller_input())

    def _go_on_from_here(self) -> bool:
        """After a transition, a hold or a rest the person's motion goes on from there.

        False while the robot is still on its way: nobody needs the person's reference yet.
        """
        if not self._placed or (machine := self.state_machine).following:
            return True
        if machine.busy:
            return False
        self.retargeter.continue_from(machine.reference, machine.facing)
        return True

    def _place_at_first_vote(self, mapped: Retargeted, command: DriveCommand) -> None:
        """The robot starts in the first voted state, unless it has been standing by already."""
        if command.directive is not Directive.FOLLOW or self._waited > FIRST_VOTE:
            self._placed = True
        elif self.person.last is not None:
            self._waited += CONTROL_DT
            if mapped.expert in STATES or self.lock is not None:
                self.place(self.lock or mapped.expert)  # type: ignore[arg-type]
                self._placed = True

    def _controller_input(self, decision: Decision | None = None) -> ControllerInput:
        """What the controller acts on; without `decision`, as it is before the first step."""
        return ControllerInput(
            reference=decision.reference if decision else self.state_machine.reference,
            robot=self.robot,
            state=decision.expert if decision else self.state_machine.state,
            in_transition=decision is not None and decision.state == "transition",
        )
