"""The control period, by which the robot, the person and all that is recorded are counted, and how
fast the paper lets joints be: what options and their help say, too."""

CONTROL_HZ = 30.0
"""Control periods a second (the paper)."""
CONTROL_DT = 1.0 / CONTROL_HZ
"""s of one."""
PAPER_JOINT_SPEED_DEG = 120.0
"""Degrees a second that a reference's joints may reach in the paper."""
