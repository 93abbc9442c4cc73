"""What the operator tries: props, steps, and success read from the state of the world."""
