"""Reference to action: controllers, policies, the environment they learn in."""
