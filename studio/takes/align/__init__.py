"""How late the person of a take was, and the warp that evens it out."""
