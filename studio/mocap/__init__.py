"""Where human motion comes from: one file per source, one registry (`open_source`)."""
