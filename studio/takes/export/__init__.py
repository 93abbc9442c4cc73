"""Takes to files other programs read: one file per format, one registry."""
