"""What a person is: the canonical skeleton, poses and clips, calibration, causal features."""
