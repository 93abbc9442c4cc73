"""Reference to action, as it runs live: controller, transitions, trackers, policies."""
