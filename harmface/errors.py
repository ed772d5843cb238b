"""The errors that harmface raises on purpose."""


class HarmfaceError(ValueError):
    """Something the caller gave cannot be used; the message names it and the remedy."""


class ArgumentError(HarmfaceError):
    """An argument has the wrong shape, range or meaning."""


class FileError(HarmfaceError):
    """A file cannot be read or written as what it claims to be."""


class FileWarning(UserWarning):
    """A file was read, but there is something to know of what it held."""
