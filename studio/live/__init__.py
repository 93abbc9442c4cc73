"""The flow in real time."""
