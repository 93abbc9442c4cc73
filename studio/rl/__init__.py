"""Reference to policy: the imitation environment, its motions, noise, rewards and curriculum."""
