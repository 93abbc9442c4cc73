"""The mapper's loss (paper, section III-A) in torch, with differentiable forward kinematics."""

from dataclasses import dataclass

import torch
from torch import Tensor

from studio.robot import a1

_OFFSET = torch.tensor(a1.HIP_OFFSET, dtype=torch.float32)
_SIDE = torch.tensor(a1.SIDE * a1.THIGH_OFFSET, dtype=torch.float32)


@dataclass(frozen=True, kw_only=True)
class LossWeights:
    """The paper's weights of orientation, joint angle, foot velocity and foot acceleration.

    `tilt` (rad^2 of the trunk's angle) and `rates` (squares of the derivative heads in sigmas, mean
    over 36) are ours, and 0 in the paper's loss: see `OURS`.
    """

    orientation: float = 0.3
    joint: float = 1.0
    foot_vel: float = 0.001
    foot_acc: float = 0.001
    tilt: float = 0.0
    rates: float = 0.0


PAPER = LossWeights()
OURS = LossWeights(tilt=2.0, rates=0.1)
"""With the paper's four terms alone the trunk and its velocity are hardly learned, for they can
cancel in the feet: trained so, a walking trunk that should stay level pitched by 2.3 degrees (RMS),
and its speed and turning rate correlated with their labels by .34 and -.01."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """A batch of robot triplets (N, ...): the same fields for a prediction and for its label.

    quat (N, 4), joint_pos/vel/acc (N, 12), lin_vel, lin_acc (N, 3) in the state's frame,
    ang_vel, ang_acc (N, 3) in the body.
    """

    quat: Tensor
    joint_pos: Tensor
    joint_vel: Tensor
    joint_acc: Tensor
    lin_vel: Tensor
    lin_acc: Tensor
    ang_vel: Tensor
    ang_acc: Tensor


def leg_motion(q: Tensor, dq: Tensor, ddq: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Foot position, velocity, acceleration (N, 4, 3) in the base frame.

    Of the angles q (N, 12) rad and their first and second derivatives dq, ddq (N, 12) a second.

    The leg is a planar two-link chain (thigh, calf) in a plane turned by the hip about x:
    u = (-l1 sin a - l2 sin b, side d, -l1 cos a - l2 cos b), a = thigh, b = thigh + calf; the
    foot is hip + Rx(h) u, and its derivatives are those of a vector in a turning frame.
    """
    q, dq, ddq = (x.reshape(-1, 4, 3) for x in (q, dq, ddq))
    h, a, b = q[..., 0], q[..., 1], q[..., 1] + q[..., 2]
    dh, da, db = dq[..., 0], dq[..., 1], dq[..., 1] + dq[..., 2]
    ddh, dda, ddb = ddq[..., 0], ddq[..., 1], ddq[..., 1] + ddq[..., 2]
    l1, l2 = a1.THIGH_LENGTH, a1.CALF_LENGTH
    sa, ca, sb, cb = torch.sin(a), torch.cos(a), torch.sin(b), torch.cos(b)
    y = _SIDE.expand_as(h)
    x, z = -l1 * sa - l2 * sb, -l1 * ca - l2 * cb
    vx, vz = -l1 * ca * da - l2 * cb * db, l1 * sa * da + l2 * sb * db
    ax = l1 * (sa * da**2 - ca * dda) + l2 * (sb * db**2 - cb * ddb)
    az = l1 * (ca * da**2 + sa * dda) + l2 * (cb * db**2 + sb * ddb)
    # The leg plane turns about x by h: e_x cross (., p, q) = (0, -q, p).
    vy, vz_t = -dh * z, vz + dh * y
    ay = -2.0 * dh * vz - ddh * z - dh**2 * y
    az_t = az + ddh * y - dh**2 * z
    ch, sh = torch.cos(h), torch.sin(h)

    def turn(px: Tensor, py: Tensor, pz: Tensor) -> Tensor:
        return torch.stack([px, ch * py - sh * pz, sh * py + ch * pz], dim=-1)

    return _OFFSET + turn(x, y, z), turn(vx, vy, vz_t), turn(ax, ay, az_t)


def rotate(quat: Tensor, v: Tensor) -> Tensor:
    """Vectors (N, K, 3) turned by quaternions (N, 4): v_a = R_a_b v_b.

    Not by `geometry.scalars.turn`, whose many small steps take half as long again with gradients.
    """
    w, u = quat[:, None, :1], quat[:, None, 1:].expand_as(v)
    t = 2.0 * torch.linalg.cross(u, v)
    return v + w * t + torch.linalg.cross(u, t)


def foot_motion(m: Motion) -> tuple[Tensor, Tensor]:
    """Foot velocity and acceleration (N, 4, 3) in the state's frame, from the triplet's parts.

    v = v_base + R (w x r + r'),  a = a_base + R (w' x r + w x (w x r) + 2 w x r' + r'').
    """
    r, dr, ddr = leg_motion(m.joint_pos, m.joint_vel, m.joint_acc)
    w, dw = m.ang_vel[:, None].expand_as(r), m.ang_acc[:, None].expand_as(r)
    cross = torch.linalg.cross
    wr = cross(w, r)
    vel = m.lin_vel[:, None] + rotate(m.quat, wr + dr)
    acc = cross(dw, r) + cross(w, wr) + 2.0 * cross(w, dr) + ddr
    return vel, m.lin_acc[:, None] + rotate(m.quat, acc)


_RATES = ("joint_vel", "joint_acc", "lin_vel", "lin_acc", "ang_vel", "ang_acc")


def mapper_loss(
    predicted: Motion,
    label: Motion,
    weights: LossWeights = PAPER,
    rate_scale: Tensor | None = None,
) -> dict[str, Tensor]:
    """The mapper's loss, averaged over the batch: its terms unweighted, and `total`.

    rate_scale (36,): sigmas of the derivatives, in the order of `Motion`'s; needed for `rates`.

    orientation 1 - (q . q_label)^2; joint: sum of squares over 12 joints, rad^2; foot_vel,
    foot_acc: sum of squares over 4 feet, (m/s)^2 and (m/s^2)^2.
    """
    vel, acc = foot_motion(predicted)
    with torch.no_grad():
        vel_label, acc_label = foot_motion(label)
    terms = {
        "orientation": 1.0 - (predicted.quat * label.quat).sum(-1).square(),
        "joint": (predicted.joint_pos - label.joint_pos).square().sum(-1),
        "foot_vel": (vel - vel_label).square().sum((-1, -2)),
        "foot_acc": (acc - acc_label).square().sum((-1, -2)),
    }
    if weights.tilt:
        # 4 (1 - (q . q_label)^2) = 4 sin^2(angle / 2): the angle squared, where it is small.
        terms["tilt"] = 4.0 * terms["orientation"]
    if weights.rates:
        assert rate_scale is not None, "the rates term needs their scale"
        error = [getattr(predicted, name) - getattr(label, name) for name in _RATES]
        terms["rates"] = (torch.cat(error, dim=1) / rate_scale).square().mean(-1)
    means = {name: term.mean() for name, term in terms.items()}
    means["total"] = torch.stack([getattr(weights, n) * v for n, v in means.items()]).sum()
    return means
