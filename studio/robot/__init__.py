"""What the A1 is, without a simulator: names, limits, poses, closed-form kinematics."""
