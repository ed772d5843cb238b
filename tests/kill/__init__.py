"""Commands killed at any moment: what they leave is whole, and the same command again succeeds."""
