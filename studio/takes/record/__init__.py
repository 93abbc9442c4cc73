"""Ticks to tapes as they happen, and back."""
