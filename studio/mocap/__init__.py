"""Adapters of real capture, one file each: files, takes and streams to human poses."""
