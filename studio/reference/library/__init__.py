"""One file per task: random goals to reference motions."""
