"""Damaged files by the thousand: each is read, or refused by name."""
