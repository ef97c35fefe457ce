"""The structs of the C interface as ctypes sees them."""

from __future__ import annotations

from ctypes import (
    POINTER,
    Structure,
    c_char,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)


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
        ("step_lasting_ns", c_int64),
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
        ("by_winding", c_void_p),
        ("uncovered", c_void_p),
        ("covered_m", c_void_p),
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
        ("surface_normal", c_double * 3),
        ("surface_depth_m", c_double),
        ("surface_depth_error_m", c_double),
        ("poses_merged", c_int32),
    ]


class PublishOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("lease_ns", c_int64),
        ("gap_ns", c_int64),
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
        ("poses_merged", c_int32),
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
        ("poses_merged", c_int32),
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
        ("poses_merged", c_int32),
    ]


class CReport(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("refused", c_char_p),
        ("names", POINTER(c_char_p)),
        ("reasons", POINTER(c_char_p)),
        ("name_count", c_size_t),
        ("left_out_count", c_uint64),
        ("merged_poses", c_uint64),
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


class RecordedOptions(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("from_since", c_int32),
        ("to_since", c_int32),
        ("reserved", c_int32),
        ("from_ns", c_int64),
        ("to_ns", c_int64),
        ("only", c_char_p),
        ("skip", c_char_p),
    ]


class RecordedAbout(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("fences", c_size_t),
        ("margins", c_size_t),
        ("nearest", c_size_t),
        ("warnings", c_size_t),
        ("lost", c_uint64),
        ("begin_ns", c_int64),
        ("end_ns", c_int64),
    ]
