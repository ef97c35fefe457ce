"""Errors as exceptions, some of which are also Python's built-in ones."""

from __future__ import annotations


class Error(Exception):
    """The reason why a call failed, and what to do next.

    hint         the next step or the consequence; may be empty
    retry_after  if an overloaded server refused: seconds until it expects to have capacity; else 0
    """

    def __init__(self, message: str, hint: str = "", retry_after: float = 0.0) -> None:
        super().__init__(f"{message}; {hint}" if hint else message)
        self.hint = hint
        self.retry_after = retry_after


class BadInput(Error, ValueError):
    """The arguments are invalid; nothing was sent."""


class NoServer(Error, ConnectionError):
    """No server answered while connecting, or it does not offer the requested feature."""


class Timeout(Error, TimeoutError):
    """No answer in time although the server is alive."""


class Refused(Error):
    """The server refused the request; the text has its reason."""


class Disconnected(Error, ConnectionError):
    """The server is silent or was replaced; the connection resumes by itself."""


class InternalError(Error):
    """DDS failed, or the answer cannot be read: server and library may be of different versions."""
