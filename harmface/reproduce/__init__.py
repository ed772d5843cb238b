"""Experiments that hold the package against the published figures."""
