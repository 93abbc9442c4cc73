"""What the mapper is compared with: simple methods, and the published rivals, each small.

`registry.RIVALS` names them; each is fitted to the same pairs as an expert and takes its place.
"""
