"""The C interface through ctypes: the loaded library, its functions, and errors as exceptions."""

from __future__ import annotations

import ctypes
import json
import operator
import os
import pathlib
import warnings
from ctypes import c_void_p
from typing import Any, Sequence, TypeVar

from ._errors import BadInput, Disconnected, Error, InternalError, NoServer, Refused, Timeout
from ._structs import BAD_INPUT, DISCONNECTED, FUNCTIONS, NO_SERVER, NOTHING, OK, REFUSED, TIMEOUT, CError

_NAME = "libcollided_client.so.2"

_ERRORS: dict[int, type[Error]] = {
    BAD_INPUT: BadInput,
    NO_SERVER: NoServer,
    TIMEOUT: Timeout,
    REFUSED: Refused,
    DISCONNECTED: Disconnected,
}


def _load() -> ctypes.CDLL:
    asked = os.environ.get("COLLIDED_LIBRARY")
    # Installed below a separate prefix, the library is next to the folder of Python's packages.
    beside = pathlib.Path(__file__).resolve().parents[3:4]
    near = [str(path) for lib in beside for path in [*lib.glob(_NAME), *lib.glob("*/" + _NAME)]]
    library, cause = None, OSError("no such file")
    for path in [asked] if asked else [_NAME, *near]:
        try:
            library = ctypes.CDLL(path)
            break
        except OSError as failed:
            cause = failed
    if library is None:
        raise ImportError(
            f"the client library of Collided cannot be loaded: {cause}; install the package libcollided2, or set "
            f"COLLIDED_LIBRARY to the path of {_NAME}"
        ) from cause
    for name, (result, arguments) in FUNCTIONS.items():
        function = getattr(library, "collided_" + name)
        function.restype = result
        function.argtypes = arguments
    return library


library = _load()


def version() -> str:
    """The version of the client library, such as "0.2.0"."""
    return str(library.collided_version().decode())


def call(name: str, *arguments: Any) -> int:
    """Calls a function that returns a code, and raises if that is an error. Warns if a successful call has something to
    report."""
    error = CError(size=ctypes.sizeof(CError))
    code = int(getattr(library, "collided_" + name)(*arguments, ctypes.byref(error)))
    if code in (OK, NOTHING):
        if error.message:
            warnings.warn(error.message.decode("utf-8", "replace"), RuntimeWarning, stacklevel=3)
        return code
    raise _ERRORS.get(code, InternalError)(
        error.message.decode("utf-8", "replace"), error.hint.decode("utf-8", "replace"), error.retry_after_ns * 1e-9
    )


def call_for_text(name: str, *arguments: Any) -> Any:
    """Calls a function whose last argument receives a JSON text, and returns the value; None without a text."""
    answer = ctypes.c_void_p()
    try:
        call(name, *arguments, ctypes.byref(answer))
        return json.loads(ctypes.string_at(answer)) if answer else None
    finally:
        library.collided_free_text(answer)


def as_json(value: dict[str, Any], what: str) -> bytes:
    """Arguments or options for C as JSON, which has no infinite numbers. Numbers and arrays of numpy have tolist()."""
    try:
        return json.dumps(value, allow_nan=False, default=operator.methodcaller("tolist")).encode()
    except (AttributeError, TypeError, ValueError) as cause:
        raise BadInput(f"{what}: {cause}", "nothing was sent") from cause


def number(value: float) -> float | str:
    """A number for JSON; an infinite one becomes a text."""
    return str(value) if value in (float("inf"), float("-inf")) else value


def encoded(text: str, what: str) -> bytes:
    """A text for C; a zero byte, which would end it early, is refused."""
    if "\0" in text:
        raise BadInput(f"{what} {text!r} holds a zero character", "nothing was sent")
    return text.encode("utf-8", "surrogateescape")


def text(value: bytes | None) -> str:
    """A text from C."""
    return (value or b"").decode("utf-8", "surrogateescape")


def word(words: tuple[str, ...], code: int) -> str:
    """The word of a code; the number of an unknown code of a newer library."""
    return words[code] if 0 <= code < len(words) else str(code)


def code_of(value: str, words: tuple[str, ...], what: str) -> int:
    """The code with this word."""
    if value not in words:
        raise BadInput(f"{what} is {value!r}; known are {', '.join(words)}", "nothing was sent")
    return words.index(value)


def nanoseconds(seconds: float, what: str) -> int:
    """Seconds as nanoseconds, limited to 292 years."""
    if not seconds >= 0:
        raise BadInput(f"{what} is {seconds} s; allowed from 0 on", "nothing was sent")
    return int(min(seconds * 1e9, 2**63 - 1025))


def connect_options(
    domain: int | None = None,
    name_space: str | None = None,
    interface: str | None = None,
    peers: Sequence[str] = (),
    wait: float = 2.0,
    keys: str = "",
    replicas: bool = True,
    wait_is_limit: bool = False,
) -> dict[str, Any]:
    """The arguments of connect() as C has them; empty: those of the environment."""
    is_chosen = domain is not None or name_space is not None or interface is not None or peers or wait != 2.0 or keys
    if not is_chosen and replicas and not wait_is_limit:
        return {}
    given = {"domain": domain or 0, "peers": list(peers), "wait_ns": nanoseconds(wait, "wait"), "keys": keys}
    given.update(replicas=bool(replicas), wait_is_limit=bool(wait_is_limit))
    given.update((name, word) for name, word in (("name_space", name_space), ("interface", interface)) if word)
    return given


Held = TypeVar("Held", bound="Owned")


class Owned:
    """An object made by the library: closed once, by close(), `with` or the garbage collector. It is unusable in a
    forked child, which lacks the library's threads."""

    _what = "it"

    def __init__(self, handle: c_void_p, close: str) -> None:
        self._kept: c_void_p | None = handle
        self._close_name = close
        self._pid = os.getpid()

    @property
    def _handle(self) -> c_void_p:
        if self._kept is None:
            raise BadInput(f"{self._what} is closed")
        if os.getpid() != self._pid:
            raise BadInput(f"{self._what} was made before a fork", "make one in the child process")
        return self._kept

    @property
    def closed(self) -> bool:
        """True after close()."""
        return self._kept is None

    def close(self) -> None:
        """Releases the object. A second call does nothing."""
        kept, self._kept = getattr(self, "_kept", None), None
        if kept is not None and os.getpid() == self._pid:
            getattr(library, "collided_" + self._close_name)(kept)

    def __enter__(self: Held) -> Held:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()
