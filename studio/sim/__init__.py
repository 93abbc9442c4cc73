"""The world: the only room that imports mujoco."""
