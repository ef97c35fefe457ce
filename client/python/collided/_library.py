"""The C interface as ctypes sees it: structs, the loaded library, and errors as exceptions."""

from __future__ import annotations

import ctypes
import os
import pathlib
from ctypes import (
    POINTER,
    Structure,
    c_char,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import Any

_NAME = "libcollided_client.so.1"


class Error(Exception):
    """What went wrong, and what to do next.

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


_ERRORS: dict[int, type[Error]] = {2: BadInput, 3: NoServer, 4: Timeout, 5: Refused, 6: Disconnected}
NOTHING = 1


class CError(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("code", c_int32),
        ("retry_after_ns", c_int64),
        ("message", c_char * 1024),
        ("hint", c_char * 512),
    ]


class ConnectOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("domain", c_int32),
        ("name_space", c_char_p),
        ("interface_name", c_char_p),
        ("wait_ns", c_int64),
        ("peers", POINTER(c_char_p)),
        ("peer_count", c_size_t),
        ("keys", c_char_p),
    ]


class CStatus(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("pid", c_uint32),
        ("name_space", c_char * 64),
        ("version_text", c_char * 32),
        ("state", c_char * 16),
        ("epoch", c_uint64),
        ("version", c_uint64),
        ("world_time_ns", c_int64),
        ("static_triangles", c_uint64),
        ("poses_applied", c_uint64),
        ("poses_dropped", c_uint64),
        ("questions_answered", c_uint64),
        ("questions_refused", c_uint64),
        ("undecided_answers", c_uint64),
        ("objects", c_uint32),
        ("moving", c_uint32),
        ("contacts", c_uint32),
        ("contacts_truncated", c_int32),
    ]


class AskOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("mode", c_int32),
        ("mask", c_uint32),
        ("max_hits", c_uint32),
        ("only", c_char_p),
        ("skip", c_char_p),
        ("error_m", c_double),
        ("deadline_ns", c_int64),
        ("timeout_ns", c_int64),
        ("fresh", c_int32),
        ("importance", c_int32),
        ("instant", c_int32),
        ("instant_ns", c_int64),
    ]


class AnswersInfo(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("has_oldest_pose", c_int32),
        ("questions", c_size_t),
        ("hits", c_size_t),
        ("epoch", c_uint64),
        ("version", c_uint64),
        ("world_time_ns", c_int64),
        ("oldest_pose_age_ns", c_int64),
        ("compute_ns", c_int64),
    ]


class Columns(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("first_hits", c_int32),
        ("verdict", c_void_p),
        ("reason", c_void_p),
        ("hit_count", c_void_p),
        ("object_id", c_void_p),
        ("triangle", c_void_p),
        ("distance_m", c_void_p),
        ("error_m", c_void_p),
        ("exit_m", c_void_p),
        ("point", c_void_p),
        ("point_error_m", c_void_p),
        ("normal", c_void_p),
        ("weights", c_void_p),
        ("time_low", c_void_p),
        ("time_high", c_void_p),
        ("inside", c_void_p),
        ("stale", c_void_p),
    ]


class CPairAnswer(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("verdict", c_int32),
        ("reason", c_int32),
        ("stale", c_int32),
        ("contained", c_int32),
        ("a_triangle", c_uint32),
        ("b_triangle", c_uint32),
        ("version", c_uint64),
        ("distance_m", c_double),
        ("depth_m", c_double),
        ("error_m", c_double),
        ("normal", c_double * 3),
        ("on_a", c_double * 3),
        ("on_b", c_double * 3),
        ("point_error_m", c_double),
        ("point", c_double * 3),
    ]


class CPart(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("numbers", c_double * 10),
        ("points", c_void_p),
        ("point_count", c_size_t),
        ("triangles", c_void_p),
        ("triangle_count", c_size_t),
    ]


class CObject(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("layers", c_uint32),
        ("mask", c_uint32),
        ("group", c_uint32),
        ("moving", c_int32),
        ("lost_policy", c_int32),
        ("name", c_char_p),
        ("parts", POINTER(CPart)),
        ("part_count", c_size_t),
        ("scale", c_double * 3),
        ("position", c_double * 3),
        ("orientation", c_double * 4),
        ("solid", c_int32),
    ]


class CEvent(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("reason", c_int32),
        ("doubt", c_int32),
        ("resync", c_int32),
        ("a_triangle", c_uint32),
        ("b_triangle", c_uint32),
        ("a", c_char_p),
        ("b", c_char_p),
        ("a_id", c_uint64),
        ("b_id", c_uint64),
        ("epoch", c_uint64),
        ("sequence", c_uint64),
        ("episode", c_uint64),
        ("world_time_ns", c_int64),
        ("began_ns", c_int64),
        ("bracket_low_s", c_double),
        ("bracket_high_s", c_double),
        ("point", c_double * 3),
        ("normal", c_double * 3),
        ("depth_m", c_double),
        ("depth_error_m", c_double),
        ("relative_velocity", c_double * 3),
        ("velocity_error", c_double),
        ("contained", c_int32),
    ]


class VoxelOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("unknown", c_int32),
        ("cell_m", c_double),
        ("reach_m", c_double),
        ("decay_ns", c_int64),
        ("layers", c_uint32),
        ("lost_policy", c_int32),
        ("most_blocks", c_size_t),
    ]


class CVoxelScan(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_int32),
        ("points", c_size_t),
        ("refused", c_size_t),
        ("far_off", c_size_t),
        ("dropped", c_size_t),
        ("occupied", c_size_t),
        ("crossed", c_size_t),
        ("changed", c_size_t),
    ]


class CFence(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("left_out_layers", c_uint32),
        ("name", c_char_p),
        ("parts", POINTER(CPart)),
        ("part_count", c_size_t),
        ("to", c_char_p),
        ("only", c_char_p),
        ("skip", c_char_p),
        ("keep", c_int32),
        ("tells", c_int32),
    ]


class CMargin(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("left_out_layers", c_uint32),
        ("name", c_char_p),
        ("around", c_char_p),
        ("only", c_char_p),
        ("skip", c_char_p),
        ("bands_m", POINTER(c_double)),
        ("band_count", c_size_t),
        ("hysteresis_m", c_double),
        ("dwell_ns", c_int64),
        ("keep", c_int32),
    ]


class CNearest(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("left_out_layers", c_uint32),
        ("name", c_char_p),
        ("only", c_char_p),
        ("to", c_char_p),
        ("skip", c_char_p),
        ("point", c_double * 3),
        ("within_m", c_double),
        ("hysteresis_m", c_double),
        ("keep", c_int32),
    ]


class CFenceEvent(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("reason", c_int32),
        ("doubt", c_int32),
        ("resync", c_int32),
        ("object", c_char_p),
        ("fence", c_char_p),
        ("epoch", c_uint64),
        ("sequence", c_uint64),
        ("episode", c_uint64),
        ("world_time_ns", c_int64),
        ("entered_ns", c_int64),
        ("bracket_low_s", c_double),
        ("bracket_high_s", c_double),
        ("left_low_s", c_double),
        ("left_high_s", c_double),
        ("point", c_double * 3),
    ]


class CMarginEvent(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("reason", c_int32),
        ("doubt", c_int32),
        ("resync", c_int32),
        ("has_contact_in", c_int32),
        ("margin", c_char_p),
        ("object", c_char_p),
        ("around", c_char_p),
        ("band_m", c_double),
        ("epoch", c_uint64),
        ("sequence", c_uint64),
        ("episode", c_uint64),
        ("world_time_ns", c_int64),
        ("entered_ns", c_int64),
        ("bracket_low_s", c_double),
        ("bracket_high_s", c_double),
        ("distance_m", c_double),
        ("distance_error_m", c_double),
        ("point", c_double * 3),
        ("normal", c_double * 3),
        ("closing_mps", c_double),
        ("closing_error_mps", c_double),
        ("contact_in_low_s", c_double),
        ("contact_in_high_s", c_double),
    ]


class CNearestEvent(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("reason", c_int32),
        ("doubt", c_int32),
        ("resync", c_int32),
        ("nearest", c_char_p),
        ("from_object", c_char_p),
        ("to", c_char_p),
        ("epoch", c_uint64),
        ("sequence", c_uint64),
        ("world_time_ns", c_int64),
        ("bracket_low_s", c_double),
        ("bracket_high_s", c_double),
        ("distance_m", c_double),
        ("distance_error_m", c_double),
        ("point", c_double * 3),
        ("normal", c_double * 3),
    ]


class WatchOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("persisted", c_int32),
        ("only", c_char_p),
        ("skip", c_char_p),
        ("capacity", c_size_t),
        ("since_ns", c_int64),
    ]


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
    "publish": (c_int32, [c_void_p, c_char_p, _OUT, _ERROR]),
    "publish_leased": (c_int32, [c_void_p, c_char_p, c_int64, _OUT, _ERROR]),
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
    "publisher_keep_alive": (c_int32, [c_void_p, _ERROR]),
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
    """Calls a function that returns a code, and raises where that is an error."""
    error = CError(size=ctypes.sizeof(CError))
    code = int(getattr(library, "collided_" + name)(*arguments, ctypes.byref(error)))
    if code in (0, NOTHING):
        return code
    raise _ERRORS.get(code, InternalError)(
        error.message.decode("utf-8", "replace"), error.hint.decode("utf-8", "replace"), error.retry_after_ns * 1e-9
    )


def encoded(text: str, what: str) -> bytes:
    """A text for C, where a zero byte would end it early."""
    if "\0" in text:
        raise BadInput(f"{what} {text!r} holds a zero character", "nothing was sent")
    return text.encode("utf-8", "surrogateescape")


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
