"""The C interface as ctypes sees it: the loaded library, its functions, and errors as exceptions."""

from __future__ import annotations

import ctypes
import os
import pathlib
import warnings
from ctypes import POINTER, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any

from ._errors import BadInput, Disconnected, Error, InternalError, NoServer, Refused, Timeout
from ._structs import (
    AnswersInfo,
    AskOptions,
    CError,
    CEvent,
    CFence,
    CFenceEvent,
    CMargin,
    CMarginEvent,
    CNearest,
    CNearestEvent,
    CObject,
    CPairAnswer,
    CReport,
    CStatus,
    CVoxelScan,
    Columns,
    ConnectOptions,
    RecordedAbout,
    RecordedOptions,
    PublishOptions,
    VoxelOptions,
    WatchOptions,
)

_NAME = "libcollided_client.so.1"

_ERRORS: dict[int, type[Error]] = {2: BadInput, 3: NoServer, 4: Timeout, 5: Refused, 6: Disconnected}
NOTHING = 1

_OUT = POINTER(c_void_p)
_ERROR = POINTER(CError)
_ASK_END = [POINTER(AskOptions), _OUT, _ERROR]
# Results and arguments of every function; without them ctypes would cut pointers to 32 bits.
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "version": (c_char_p, []),
    "connect": (c_int32, [POINTER(ConnectOptions), _OUT, _ERROR]),
    "close": (None, [c_void_p]),
    "get_status": (c_int32, [c_void_p, POINTER(CStatus), _ERROR]),
    "ask_defaults": (None, [POINTER(AskOptions), c_uint32]),
    "ask_rays": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, c_void_p, *_ASK_END]),
    "ask_spheres": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, *_ASK_END]),
    "ask_boxes": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, c_void_p, *_ASK_END]),
    "ask_nearest": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, *_ASK_END]),
    "ask_inside": (c_int32, [c_void_p, c_size_t, c_void_p, *_ASK_END]),
    "free_answers": (None, [c_void_p]),
    "get_info": (None, [c_void_p, POINTER(AnswersInfo)]),
    "read_columns": (None, [c_void_p, POINTER(Columns)]),
    "hit_object": (c_char_p, [c_void_p, c_size_t]),
    "pair": (c_int32, [c_void_p, c_char_p, c_char_p, c_int64, POINTER(CPairAnswer), _ERROR]),
    "what_if": (
        c_int32,
        [c_void_p, POINTER(c_char_p), c_size_t, c_size_t, c_void_p, POINTER(c_char_p), c_size_t, c_double, *_ASK_END],
    ),
    "object_defaults": (None, [POINTER(CObject), c_uint32]),
    "add": (c_int32, [c_void_p, POINTER(CObject), POINTER(c_uint64), _ERROR]),
    "move": (c_int32, [c_void_p, c_char_p, c_void_p, c_void_p, c_int32, _ERROR]),
    "remove": (c_int32, [c_void_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "allow": (c_int32, [c_void_p, c_char_p, c_char_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "deny": (c_int32, [c_void_p, c_char_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "attach": (c_int32, [c_void_p, c_char_p, c_char_p, _ERROR]),
    "detach": (c_int32, [c_void_p, c_char_p, _ERROR]),
    "command": (c_int32, [c_void_p, c_char_p, c_char_p, c_int64, _OUT, _ERROR]),
    "free_text": (None, [c_void_p]),
    # The callback stays null: events are polled, so that no thread of the library waits for Python's lock.
    "watch_start": (c_int32, [c_void_p, POINTER(WatchOptions), c_void_p, c_void_p, _OUT, _ERROR]),
    "watch_next": (c_int32, [c_void_p, c_int64, POINTER(CEvent), _ERROR]),
    "watch_lost": (c_uint64, [c_void_p]),
    "watch_in_step": (c_int32, [c_void_p]),
    "watch_close": (None, [c_void_p]),
    "fence_add": (c_int32, [c_void_p, POINTER(CFence), _ERROR]),
    "fence_remove": (c_int32, [c_void_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "margin_add": (c_int32, [c_void_p, POINTER(CMargin), _ERROR]),
    "margin_remove": (c_int32, [c_void_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "fence_watch_start": (c_int32, [c_void_p, c_char_p, c_char_p, _OUT, _ERROR]),
    "fence_watch_next": (c_int32, [c_void_p, c_int64, POINTER(CFenceEvent), _ERROR]),
    "fence_watch_lost": (c_uint64, [c_void_p]),
    "fence_watch_in_step": (c_int32, [c_void_p]),
    "fence_watch_close": (None, [c_void_p]),
    "margin_watch_start": (c_int32, [c_void_p, c_char_p, c_char_p, _OUT, _ERROR]),
    "margin_watch_next": (c_int32, [c_void_p, c_int64, POINTER(CMarginEvent), _ERROR]),
    "margin_watch_lost": (c_uint64, [c_void_p]),
    "margin_watch_in_step": (c_int32, [c_void_p]),
    "margin_watch_close": (None, [c_void_p]),
    "nearest_add": (c_int32, [c_void_p, POINTER(CNearest), _ERROR]),
    "nearest_remove": (c_int32, [c_void_p, c_char_p, POINTER(c_uint64), _ERROR]),
    "nearest_watch_start": (c_int32, [c_void_p, c_char_p, c_char_p, _OUT, _ERROR]),
    "nearest_watch_next": (c_int32, [c_void_p, c_int64, POINTER(CNearestEvent), _ERROR]),
    "nearest_watch_lost": (c_uint64, [c_void_p]),
    "nearest_watch_in_step": (c_int32, [c_void_p]),
    "nearest_watch_close": (None, [c_void_p]),
    "read_recorded_fences": (c_int32, [c_char_p, POINTER(RecordedOptions), _OUT, _ERROR]),
    "free_recorded_fences": (None, [c_void_p]),
    "about_recorded_fences": (None, [c_void_p, POINTER(RecordedAbout)]),
    "recorded_fence_event": (c_int32, [c_void_p, c_size_t, POINTER(CFenceEvent)]),
    "recorded_margin_event": (c_int32, [c_void_p, c_size_t, POINTER(CMarginEvent)]),
    "recorded_nearest_event": (c_int32, [c_void_p, c_size_t, POINTER(CNearestEvent)]),
    "recorded_warning": (c_char_p, [c_void_p, c_size_t]),
    "publish": (c_int32, [c_void_p, c_char_p, _OUT, _ERROR]),
    "publish_leased": (c_int32, [c_void_p, c_char_p, c_int64, _OUT, _ERROR]),
    "publish_defaults": (None, [POINTER(PublishOptions), c_uint32]),
    "publish_with": (c_int32, [c_void_p, c_char_p, POINTER(PublishOptions), _OUT, _ERROR]),
    "publisher_close": (None, [c_void_p]),
    "publisher_add": (c_int32, [c_void_p, POINTER(CObject), POINTER(c_uint32), _ERROR]),
    "publisher_claim": (
        c_int32,
        [c_void_p, c_char_p, POINTER(c_double), POINTER(c_double), c_int32, POINTER(c_uint32), _ERROR],
    ),
    "publisher_remove": (c_int32, [c_void_p, c_uint32, _ERROR]),
    "publisher_move": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, c_void_p, c_int32, _ERROR]),
    "publisher_flush": (c_int32, [c_void_p, c_int64, POINTER(c_uint64), _ERROR]),
    "publisher_wait_applied": (c_int32, [c_void_p, c_int64, _ERROR]),
    "publisher_report": (c_int32, [c_void_p, c_int64, POINTER(CReport), _ERROR]),
    "publisher_keep_alive": (c_int32, [c_void_p, _ERROR]),
    "publisher_keep_alive_at": (c_int32, [c_void_p, c_int64, _ERROR]),
    "publisher_stream": (None, [c_void_p]),
    "voxel_defaults": (None, [POINTER(VoxelOptions), c_uint32]),
    "voxels_start": (c_int32, [c_void_p, c_char_p, POINTER(VoxelOptions), _OUT, _ERROR]),
    "voxels_close": (None, [c_void_p]),
    "voxels_insert": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, c_int64, POINTER(CVoxelScan), _ERROR]),
    "voxels_insert_floats": (c_int32, [c_void_p, c_size_t, c_void_p, c_void_p, c_int64, POINTER(CVoxelScan), _ERROR]),
    "voxels_decay": (c_int32, [c_void_p, c_int64, POINTER(c_size_t), _ERROR]),
    "voxels_clear": (c_int32, [c_void_p, _ERROR]),
}


def _load() -> ctypes.CDLL:
    asked = os.environ.get("COLLIDED_LIBRARY")
    # Installed below a prefix of its own, it lies beside the folder of Python's packages.
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
            f"the client library of Collided cannot be loaded: {cause}; install the package libcollided1, or set "
            f"COLLIDED_LIBRARY to the path of {_NAME}"
        ) from cause
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, "collided_" + name)
        function.restype = result
        function.argtypes = arguments
    return library


library = _load()


def version() -> str:
    """The version of the client library, such as "0.2.0"."""
    return str(library.collided_version().decode())


def call(name: str, *arguments: Any) -> int:
    """Calls a function that returns a code, and raises where that is an error. Warns of what a call that went well has to
    report."""
    error = CError(size=ctypes.sizeof(CError))
    code = int(getattr(library, "collided_" + name)(*arguments, ctypes.byref(error)))
    if code in (0, NOTHING):
        if error.message:
            warnings.warn(error.message.decode("utf-8", "replace"), RuntimeWarning, stacklevel=3)
        return code
    raise _ERRORS.get(code, InternalError)(
        error.message.decode("utf-8", "replace"), error.hint.decode("utf-8", "replace"), error.retry_after_ns * 1e-9
    )


def encoded(text: str, what: str) -> bytes:
    """A text for C, where a zero byte would end it early."""
    if "\0" in text:
        raise BadInput(f"{what} {text!r} holds a zero character", "nothing was sent")
    return text.encode("utf-8", "surrogateescape")


def word(words: tuple[str, ...], code: int) -> str:
    """The word of a code, or its number where a newer library has more."""
    return words[code] if 0 <= code < len(words) else str(code)


def code_of(value: str, words: tuple[str, ...], what: str) -> int:
    """The code that has this word."""
    if value not in words:
        raise BadInput(f"{what} is {value!r}; known are {', '.join(words)}", "nothing was sent")
    return words.index(value)


def nanoseconds(seconds: float, what: str) -> int:
    """Seconds as the library counts them; more than 292 years is as long as 292 years."""
    if not seconds >= 0:
        raise BadInput(f"{what} is {seconds} s; allowed from 0 on", "nothing was sent")
    return int(min(seconds * 1e9, 2**63 - 1025))


class Owned:
    """Something that the library made: closed once, by close(), `with` or the garbage collector, and of no use in a
    forked child, which has none of the library's threads."""

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
        """Gives it up. A second time does nothing."""
        kept, self._kept = getattr(self, "_kept", None), None
        if kept is not None and os.getpid() == self._pid:
            getattr(library, "collided_" + self._close_name)(kept)

    def __del__(self) -> None:
        self.close()
