"""The control period, by which the robot, the person and all that is recorded are counted."""

CONTROL_HZ = 30.0
"""Control periods a second (the paper)."""
CONTROL_DT = 1.0 / CONTROL_HZ
"""s of one."""
