"""What live references and cheap sensors do to clean numbers: drifts, bias, repeated frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.robot import a1

Array = NDArray[np.float64]

# σ of each entry of p̄ per unit of joint σ: joints; height (m); roll, pitch; yaw rate; velocities.
# Velocities are a whole trunk's, steadier than any one joint: with as much noise as a joint's
# a policy learns to turn by half of what it is asked.
_FEATURE_SIGMA = np.concatenate([np.ones(12), [0.1, 0.4, 0.4, 0.3, 0.25, 0.15]])


@dataclass(frozen=True, kw_only=True)
class NoiseConfig:
    """Reference noise and sensor noise.

    joint_sigma: rad, range of the Ornstein-Uhlenbeck noise's σ on the reference's joints, drawn
    once an episode; tau: s, its time constant; the rest of p̄ follows in proportion. repeat: range
    of the share of frames that repeat the one before. encoder, encoder_bias: rad; imu_bias: rad of
    roll and pitch; gyro: rad/s. clean: share of the episodes whose reference has no noise at all.
    """

    joint_sigma: tuple[float, float] = (np.deg2rad(2.0), np.deg2rad(4.0))
    tau: float = 0.3
    repeat: tuple[float, float] = (0.0, 0.05)
    encoder: float = 0.003
    encoder_bias: float = 0.005
    imu_bias: float = 0.005
    gyro: float = 0.05
    clean: float = 0.0


def ou_step(noise: Array, sigma: Array, tau: float, dt: float, rng: np.random.Generator) -> Array:
    """One Ornstein-Uhlenbeck step of stationary σ: ρ n + σ √(1 − ρ²) ξ, ρ = e^(−dt/τ).

    noise: (N, D); sigma: broadcasts against it.
    """
    rho = np.exp(-dt / tau)
    return rho * noise + sigma * np.sqrt(1.0 - rho**2) * rng.standard_normal(noise.shape)


class ReferenceNoise:
    """Ornstein-Uhlenbeck noise and repeated frames on N references; one thread only."""

    def __init__(self, num_envs: int, config: NoiseConfig, rng: np.random.Generator) -> None:
        self.config, self.rng = config, rng
        self.value = np.zeros((num_envs, 18))
        self.sigma = np.zeros((num_envs, 18))
        self.repeat = np.zeros(num_envs)
        self.last = np.zeros((num_envs, 18))

    def reset(self, ids: NDArray[np.intp], clean: Array, scale: float = 1.0) -> Array:
        """New noise for `ids` at its stationary spread; returns the noisy first frame (n, 18)."""
        n = len(ids)
        low, high = self.config.joint_sigma
        size = self.rng.uniform(low, high, (n, 1))
        self.repeat[ids] = scale * self.rng.uniform(*self.config.repeat, n)
        if self.config.clean:
            clean_ones = self.rng.random(n) < self.config.clean
            size[clean_ones] = 0.0
            self.repeat[ids[clean_ones]] = 0.0
        self.sigma[ids] = scale * size * _FEATURE_SIGMA
        self.value[ids] = self.sigma[ids] * self.rng.standard_normal((n, 18))
        self.last[ids] = _limited(clean + self.value[ids])
        return self.last[ids]

    def step(self, clean: Array) -> Array:
        """The next noisy frame (N, 18) of every reference."""
        self.value = ou_step(self.value, self.sigma, self.config.tau, a1.CONTROL_DT, self.rng)
        again = self.rng.random(len(clean)) < self.repeat
        self.last = np.where(again[:, None], self.last, _limited(clean + self.value))
        return self.last


def _limited(feature: Array) -> Array:
    """Joint angles of p̄ within their limits, as the retargeter sends them."""
    feature[:, :12] = np.clip(feature[:, :12], a1.JOINT_LOWER, a1.JOINT_UPPER)
    return feature
