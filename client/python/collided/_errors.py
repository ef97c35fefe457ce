"""Errors as exceptions, which are Python's own as well."""

from __future__ import annotations


class Error(Exception):
    """The reason why a call failed, and what to do next.

    hint         the next step or the consequence; may be empty
    retry_after  seconds until the server expects to have room, where it refused for want of it; else 0
    """

    def __init__(self, message: str, hint: str = "", retry_after: float = 0.0) -> None:
        super().__init__(f"{message}; {hint}" if hint else message)
        self.hint = hint
        self.retry_after = retry_after


class BadInput(Error, ValueError):
    """The arguments cannot be meant; nothing was sent."""


class NoServer(Error, ConnectionError):
    """No server answered while connecting, or it does not offer what was asked for."""


class Timeout(Error, TimeoutError):
    """No answer in time although the server lives."""


class Refused(Error):
    """The server refused the request and said why."""


class Disconnected(Error, ConnectionError):
    """The server has been silent or was replaced; the connection resumes by itself."""


class InternalError(Error):
    """DDS failed, or the answer cannot be read: server and library may be of different versions."""
