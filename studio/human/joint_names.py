"""The names that joints go by in files → which joint of a file is which canonical one.

One table of synonyms for every convention. What a file decorates its names with (a prefix, a
suffix, numbers, either place of the side) is found from the names themselves.
"""

import unicodedata
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.sensor_skeletons import AXES_Y_UP, SourceSkeleton, skeleton_of

Array = NDArray[np.float64]
Parts = dict[str, list[str]]
"""Canonical joint → the joints of a file whose middle it is."""

SYNONYMS: dict[str, tuple[str, ...]] = {
    "hip": ("upleg", "upperleg", "legupper", "thigh", "thighbend", "femur", "hip", "大腿", "足",
            "leg"),
    "knee": ("knee", "lowleg", "loleg", "lowerleg", "leglower", "shin", "shinbend", "calf", "tibia",
             "ひざ", "膝", "小腿", "leg"),
    "ankle": ("ankle", "足首", "foot", "脚"),
    "toe": ("toebase", "toe", "toes", "ball", "つま先", "爪先", "足先ex", "footend", "foot"),
    "shoulder": ("uparm", "upperarm", "armupper", "upperarmbend", "uarm", "shldrbend", "shldr",
                 "humerus", "腕", "上臂", "arm", "shoulder"),
    "elbow": ("forearm", "forearmbend", "elbow", "lowarm", "loarm", "lowerarm", "armlower", "farm",
              "radius", "ひじ", "肘", "前臂"),
    "wrist": ("wrist", "手首", "hand", "手"),
}  # fmt: skip
"""Best first, lower case, letters only. MotionBuilder's LeftShoulder is a collar bone and its
LeftLeg a shin, elsewhere they are a shoulder and a thigh: hence last in their rows."""
HEADS = ("head", "chead", "skull", "頭", "头")
HEAD_TOPS = ("headtopend", "headtop", "headend", "headnub")
NECKS = ("neck", "cneck", "neckupper", "首")
SIDES = {"l": ("left", "l", "左"), "r": ("right", "r", "右")}
CHAINS = (("hip", "knee", "ankle", "toe"), ("shoulder", "elbow", "wrist"))
MAPPABLE = (*(f"{s}_{j}" for chain in CHAINS for s in SIDES for j in chain), "head")
"""What a joint map may name: the trunk is defined by hips and shoulders."""
NEEDED = tuple(f"{s}_{j}" for j in ("shoulder", "hip", "knee", "ankle") for s in SIDES)

_FORMS = {
    f"{side}_{joint}": [
        form
        for synonym in synonyms
        for word in words
        # "LeftArm", "l_arm" and Blender's "arm.L" alike
        for form in (word + synonym, synonym + word)
    ]
    for joint, synonyms in SYNONYMS.items()
    for side, words in SIDES.items()
}
_MOST = 5
"""Joints of a file looked at for one canonical joint, and decorations of names tried."""


class UnmappedJoints(StudioError):
    """Joints that are needed were not found: a joint map would help."""


def find_joints(
    names: Sequence[str],
    parents: Sequence[int] | None = None,
    by_hand: Mapping[str, Sequence[str]] | None = None,
) -> Parts:
    """As `guess_joints`; UnmappedJoints, with what was looked for and what is there, when hips,
    knees, ankles or shoulders are not found."""
    parts = guess_joints(names, parents, by_hand)
    missing = [joint for joint in NEEDED if joint not in parts]
    if missing:
        raise UnmappedJoints(_not_found(missing, names))
    return parts


def guess_joints(
    names: Sequence[str],
    parents: Sequence[int] | None = None,
    by_hand: Mapping[str, Sequence[str]] | None = None,
) -> Parts:
    """Which of a file's joints make each canonical one; what is not found is left out.

    names: in file order; the end site of joint J is "J/end". parents: the index of each one's
    parent, where known: limbs then run along the hierarchy if they can. by_hand: what a person
    says, by canonical joint; that replaces the guess, and no joints at all leave it out.
    StudioError for a joint or name there that is not known.
    """
    by_hand = dict(by_hand or {})
    check_joint_map(by_hand, names)
    index = {name: i for i, name in enumerate(names)}
    plain = _plain(names)
    best: Parts = {}
    for prefix, suffix in _decorations(plain):
        parts = _match(plain, prefix, suffix, index, parents)
        if len(parts) > len(best):
            best = parts
    for joint, sources in by_hand.items():
        best.pop(joint, None)
        if sources:
            best[joint] = list(sources)
    return best


def check_joint_map(by_hand: Mapping[str, Sequence[str]], names: Sequence[str]) -> None:
    """StudioError unless a joint map names canonical joints, and joints that there are."""
    for joint, sources in by_hand.items():
        if joint not in MAPPABLE:
            raise StudioError(f"joint map: no joint {joint[:40]!r}; known: {', '.join(MAPPABLE)}")
        for source in sources:
            if source not in names:
                raise StudioError(
                    f"joint map: {joint} is said to be {source[:60]!r}; there is {_listed(names)}"
                )


def _not_found(missing: Sequence[str], names: Sequence[str]) -> str:
    sought = ", ".join(f"Left{s.capitalize()}" for s in SYNONYMS[missing[0][2:]] if s.isascii())
    return (
        f"no joint for {', '.join(missing)}: looked for {sought} … (or as l_, L, .L, 左); there is "
        f"{_listed(names)}; say which is which by a joint map (--joint-map FILE), "
        f'{{"{missing[0]}": "NAME", …}}'
    )


def _listed(names: Sequence[str]) -> str:
    own = [name[:40] for name in names if not name.endswith("/end")]
    return ", ".join(own[:40]) + (f" and {len(own) - 40} more" if len(own) > 40 else "")


def _plain(names: Sequence[str]) -> dict[str, list[str]]:
    """Names by their letters alone, lower case; those that share them by their number."""
    out: dict[str, list[tuple[int, str]]] = defaultdict(list)
    for name in names:
        if name.endswith("/end"):
            continue
        own = unicodedata.normalize("NFKC", name.rsplit(":", 1)[-1]).lower()  # mixamorig:LeftArm
        number = "".join(ch for ch in own if ch.isdecimal())
        key = "".join(ch for ch in own if ch.isalpha())
        out[key].append((int(number[:9]) if number else -1, name))
    return {key: [n for _, n in sorted(own, key=lambda o: o[0])] for key, own in out.items()}


def _decorations(plain: Mapping[str, Sequence[str]]) -> list[tuple[str, str]]:
    """What may stand before and after a joint's own name in this file, the likeliest first."""
    seen: Counter[tuple[str, str]] = Counter()
    for key in plain:
        around = set()
        for forms in _FORMS.values():
            for form in forms:
                if (at := key.find(form)) >= 0:
                    around.add((key[:at], key[at + len(form) :]))
        seen.update(around)
    common = sorted(seen, key=lambda d: (-seen[d], len(d[0]) + len(d[1]), d))
    return [("", ""), *(d for d in common[:_MOST] if d != ("", ""))]


def _match(
    plain: Mapping[str, Sequence[str]],
    prefix: str,
    suffix: str,
    index: Mapping[str, int],
    parents: Sequence[int] | None,
) -> Parts:
    """The parts found where every name is dressed in this prefix and suffix."""

    def among(forms: Sequence[str]) -> list[str]:
        return [name for form in forms for name in plain.get(prefix + form + suffix, ())]

    parts: Parts = {}
    for chain in CHAINS:
        for side in SIDES:
            options = [among(_FORMS[f"{side}_{joint}"])[:_MOST] for joint in chain]
            chosen = _chain(options, index, parents)
            parts |= {f"{side}_{j}": [n] for j, n in zip(chain, chosen, strict=True) if n}
            foot = parts.get(f"{side}_ankle", [""])[0] + "/end"
            if "toe" in chain and f"{side}_toe" not in parts and foot in index:
                parts[f"{side}_toe"] = [foot]
    head = among(HEADS) or among(NECKS)[::-1]  # of several necks the last: it is the highest
    if head:
        top = [f"{head[0]}/end"] if f"{head[0]}/end" in index else among(HEAD_TOPS)[:1]
        parts["head"] = [head[0], *top]
    return parts


def _chain(
    options: Sequence[Sequence[str]], index: Mapping[str, int], parents: Sequence[int] | None
) -> Sequence[str | None]:
    """One name a joint along a limb: as many as can be, each below the one before, best first."""

    def badness(chosen: Sequence[str | None]) -> tuple[int, ...]:
        there = [name for name in chosen if name is not None]
        if len(set(there)) < len(there):
            return (len(chosen) + 1,)
        stray = 0
        if parents is not None:
            stray = sum(not _below(index[b], index[a], parents) for a, b in pairwise(there))
        rank = (o.index(c) if c is not None else len(o) for o, c in zip(options, chosen))
        return (chosen.count(None), stray, *rank)

    return min(product(*([*o, None] for o in options)), key=badness)


def _below(joint: int, ancestor: int, parents: Sequence[int]) -> bool:
    while joint > ancestor:  # parents come before their children
        joint = parents[joint]
    return joint == ancestor


def bvh_skeleton(
    names: Sequence[str],
    axes: Array = AXES_Y_UP,
    parents: Sequence[int] | None = None,
    by_hand: Mapping[str, Sequence[str]] | None = None,
) -> SourceSkeleton:
    """The map of a hierarchy of named joints onto the canonical ones; see `find_joints`.

    axes: rotation matrix (3, 3) from the file's world to ours.
    """
    return skeleton_of("bvh", names, axes, find_joints(names, parents, by_hand))
