"""What the operator tries: props, a goal, success(state)."""
