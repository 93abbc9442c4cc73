"""What was recorded elsewhere to takes: a motion file becomes the human side of one.

Imports nothing of the web: the process for files runs it (`web.worker_process`).
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.files import scratch_folder
from studio.human.pose import HumanClip
from studio.mocap.bvh import read_bvh
from studio.mocap.frames import read_frames
from studio.mocap.joint_maps import JointMap, JointMaps, read_joint_map
from studio.mocap.recorded import Recorded
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.takes import commands
from studio.takes.export import adding
from studio.takes.export.archive import import_zip
from studio.takes.names import check_take, slug, take_folder
from studio.takes.record.meta import TAPE
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import Take
from studio.takes.tick import Tick, tick_at_rest

SUFFIXES = (".bvh", ".jsonl", ".json", ".ndjson")
MAX_SECONDS = 6 * 3600.0
KINDS = (
    f"send a take (its {TAPE}, with meta.json; or exported, .mcap), a .zip of takes or of a"
    " LeRobotDataset of ours, a .bvh or human frames (.jsonl)"
)


def take_in(sessions: Path, stored: list[Path], robot: str | None) -> dict[str, Any]:
    """Import what a page has sent: {"takes", "refused", "rejected"}; StudioError if nothing was."""
    nothing = {"rejected": 0, "refused": {}}
    if any(file.name == TAPE for file in stored):
        taken, why = adding.add_all(sessions, [stored[0].parent])
        if not taken:
            raise StudioError("; ".join(why.values()))
        return nothing | {"takes": taken}
    if len(stored) == 1 and stored[0].suffix.lower() in (".zip", ".mcap", *SUFFIXES):
        return nothing | import_take(sessions, stored[0], robot=robot)
    raise StudioError(KINDS)


def import_take(
    sessions: Path,
    path: Path,
    name: str | None = None,
    robot: str | None = None,
    joint_map: Path | None = None,
) -> dict[str, Any]:
    """Take in what was recorded elsewhere: takes (a folder of one or of many, a zip, what `export`
    made of them) or a motion.

    A motion file (.bvh, or human frames as .jsonl) becomes the human side of a take. robot: the
    take whose robot that person is put beside; without one the robot stands by. joint_map: a JSON
    file that says which joint of a BVH is which. From a zip or a folder of takes, they get names
    that are free, and those refused are named with why.
    """
    kind = path.suffix.lower() if path.is_file() and path.name != TAPE else ""
    if kind and kind not in (".zip", ".mcap"):
        said = read_joint_map(joint_map) if joint_map is not None else None
        return import_human(sessions, path, name, robot, said)
    if robot is not None:
        raise StudioError("a robot is put beside a motion file (.bvh, .jsonl), not beside a take")
    if joint_map is not None:
        raise StudioError("a joint map says which joint of a .bvh is which; takes need none")
    if kind == ".mcap":
        try:
            return {"takes": [adding.add_mcap(Path(sessions), path, name)]}
        except OSError as error:
            raise StudioError(f"{path.name} was not imported: {error.strerror}") from error
    if kind == ".zip":
        if name is not None:
            raise StudioError("the takes in a zip have names of their own: leave the name out")
        found = import_zip(Path(sessions), path)
        if not found["takes"]:
            raise StudioError("; ".join(found["refused"].values()) or f"{path.name} holds no take")
        return found
    return commands.import_take(sessions, path.parent if path.name == TAPE else path, name)


def read_motion(
    path: Path, joint_map: JointMap | None = None, remembered: JointMaps | None = None
) -> Recorded:
    """A BVH or a file of human frames, by its suffix; StudioError for any other."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise StudioError(f"{path.name} is no motion file: give a .bvh, or human frames as .jsonl")
    if suffix == ".bvh":
        return read_bvh(path, joint_map, remembered)
    if joint_map is not None:
        raise StudioError("a joint map says which joint of a .bvh is which; frames need none")
    return read_frames(path)


def import_human(
    sessions: Path,
    file: Path,
    name: str | None = None,
    robot: str | None = None,
    joint_map: JointMap | None = None,
) -> dict[str, Any]:
    """Make a take of a BVH or a file of human frames: {"takes": [NAME], "rejected": frames,
    "notes": what was read differently from how it is written}.

    robot: a take whose robot this person is put beside, from its first tick on, as long as both
    last; without one the robot stands by in neutral. joint_map: which joint of a BVH is which,
    remembered for others with the same joint names. A pause stays one: no frame is new in it.
    Raises StudioError for a file that cannot be read, an unknown take, and a name that is taken.
    """
    recorded = read_motion(file, joint_map, JointMaps(sessions))
    clip = recorded.clip
    if clip.t[-1] - clip.t[0] > MAX_SECONDS:
        raise StudioError(
            f"{file.name} lasts {(clip.t[-1] - clip.t[0]) / 3600:.1f} h, more than a take may"
            f" ({MAX_SECONDS / 3600:g} h): check its times, or cut it"
        )
    library = SessionLibrary(sessions)
    beside = library.read(robot) if robot else None
    about = {"source": f"import:{file.name}"} | ({"robot": robot} if robot else {})
    if beside is not None and "collect" in (beside.meta.get("about") or {}):
        about["collect"] = beside.meta["about"]["collect"]
    label = beside.label if beside is not None else slug(file.stem)
    if name is not None and take_folder(sessions, check_take(name)).exists():
        raise StudioError(f"a take named {name} exists: give another name")
    try:
        Path(sessions).mkdir(parents=True, exist_ok=True)
        # Beside the library, not in it: a studio may be recording there.
        with scratch_folder(adding.SCRATCH, Path(sessions)) as scratch:
            recorder = Recorder(scratch)
            try:
                made = recorder.start(label, name=name, about=about)
                for tick in _ticks(clip, beside):
                    recorder.append(tick)
            finally:
                recorder.close()
            free = name or adding.free_name(library.root, made)
            return {
                "takes": [library.add(scratch / made, free)],
                "rejected": recorded.report.refused.frames,
                "notes": list(recorded.report.notes),
            }
    except OSError as error:
        raise StudioError(f"{file.name} was not imported: {error.strerror}") from error


_OF_ROBOT = (
    "expert", "state", "controller", "reference", "action", "target", "robot", "fallen"
)  # fmt: skip


def _ticks(clip: HumanClip, beside: Take | None) -> Iterator[Tick]:
    """The clip's frames beside the robot of a take, or beside one that stands.

    Imported alone, nothing says what the person meant: no pairs until the take is labelled.
    """
    newest = clip.newest(a1.CONTROL_HZ).tolist()
    count = len(newest) if beside is None else min(len(newest), len(beside))
    for i in range(count):
        then = None if beside is None else beside.ticks[i]
        known = {} if then is None else {key: getattr(then, key) for key in _OF_ROBOT}
        human = replace(clip[newest[i]], t=float(clip.t[newest[i]] - clip.t[0]))
        known["human_fresh"] = i == 0 or newest[i] > newest[i - 1]
        yield tick_at_rest(i, human, NEUTRAL["stand"], **known)
