"""The memory: ticks, takes as crash-safe tapes, the library of sessions."""
