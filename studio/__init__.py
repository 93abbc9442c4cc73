"""A1 Studio: drive a Unitree A1 with your own body.

Follow one frame by reading the rooms in order:
  mocap      a source gives a HumanPose                (human/ says what that is)
  retarget   features -> selector -> mapper -> contact and temporal consistency -> ReferencePose
  imitation  controller (stand | walk | sit | transition) -> policy -> action
  sim        low-pass, limits, PD -> the simulated A1  (robot/ says what that is)
  puppeteer  the flow above on one page: step(HumanPose) -> Tick
  live       the flow in real time; recording keeps it; web shows it; evaluation scores it.
"""

__version__ = "0.1.0"
