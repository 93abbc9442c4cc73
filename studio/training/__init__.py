"""Mappers and policies, each read top to bottom."""
