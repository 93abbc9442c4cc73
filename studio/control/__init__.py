"""Reference to action, as it runs live: state machine, transitions, controllers, policies."""
