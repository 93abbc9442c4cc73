"""The memory: ticks, takes as crash-safe tapes, the folder of them."""
