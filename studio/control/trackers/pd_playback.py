"""The reference's joint angles straight to the PD: what any policy has to beat."""

from studio.control.trackers.tracker import Array, Situation, Tracker


class PdPlayback(Tracker):
    """Remembers nothing."""

    name = "pd_playback"

    def act(self, now: Situation) -> Array:
        """(12,) rad: the reference's joint angles."""
        return now.reference.joint_pos
