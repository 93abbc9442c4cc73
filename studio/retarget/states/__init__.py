"""What each expert covers."""
