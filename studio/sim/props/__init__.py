"""Things the robot meets: ball, box, target, slope."""
