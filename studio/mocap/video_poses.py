"""A program: the person in each picture of a video, a human frame (docs/contract.md) a line.

It runs in a process of its own, and imports nothing of the studio: video decoders and the model are
other people's C, whose crash must not take a robot along, and may live in another environment.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

MAX_FRAMES = 36_000
"""Twenty minutes at 30 pictures a second."""
MAX_PIXELS = 4096 * 4096
UNUSABLE = 3
"""Exit status: the last line of standard error says why, for people."""


def _say(landmarks: Any, world: Any, t: float) -> str:
    """The frame, in m and s; places to a tenth of a millimetre."""
    return json.dumps(
        {
            "t": round(t, 6),
            "skeleton": "mediapipe",
            "positions": [[round(v, 4) for v in (j.x, j.y, j.z)] for j in world],
            "confidence": [round(min(max(j.visibility or 0.0, 0.0), 1.0), 4) for j in landmarks],
        }
    )


def _fail(why: str) -> None:
    sys.stderr.write(f"\n{why}\n")
    raise SystemExit(UNUSABLE)


def main(video: str, model: str) -> None:
    """Write frames until the video ends; then {"pictures": how many it had}."""
    try:
        import cv2  # type: ignore[import-not-found]
        import mediapipe as mp  # type: ignore[import-not-found]
    except ImportError as error:
        _fail(f"video needs MediaPipe (pip install 'a1-studio[video]'): {error}")
        return
    opened = cv2.VideoCapture(video)
    ok, picture = opened.read()
    if not ok:
        _fail(f"{Path(video).name} is no video that can be read")
    if picture.shape[0] * picture.shape[1] > MAX_PIXELS:
        _fail(f"{Path(video).name} has pictures of more than {MAX_PIXELS} pixels")
    vision = mp.tasks.vision
    options = vision.PoseLandmarkerOptions(
        base_options=mp.tasks.BaseOptions(model_asset_path=model),
        running_mode=vision.RunningMode.VIDEO,
    )
    rate = opened.get(cv2.CAP_PROP_FPS)
    rate = rate if 1.0 <= rate <= 1000.0 else 30.0
    count, last, asker = 0, -1.0, os.getppid()
    with vision.PoseLandmarker.create_from_options(options) as model_of:
        while ok and count < MAX_FRAMES:
            if os.getppid() != asker:
                return  # killed: nobody waits for the rest
            t = opened.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            if not t > last:  # no clock of its own, or one that jumps
                t = last + 1.0 / rate if count else 0.0
            image = mp.Image(
                image_format=mp.ImageFormat.SRGB, data=cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)
            )
            # Its times are whole milliseconds that must grow.
            seen = model_of.detect_for_video(image, max(round(1000 * t), round(1000 * last) + 1))
            if seen.pose_world_landmarks:
                line = _say(seen.pose_landmarks[0], seen.pose_world_landmarks[0], t)
                sys.stdout.write(line + "\n")
            count, last = count + 1, t
            ok, picture = opened.read()
    sys.stderr.write(json.dumps({"pictures": count, "whole": not ok}) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:3])
