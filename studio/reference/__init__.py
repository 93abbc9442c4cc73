"""What the robot should do: intents, reference motions, gaits, contacts, consistency."""
