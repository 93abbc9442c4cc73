"""What was decided about a take, beside its tape."""
