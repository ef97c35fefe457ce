#pragma once

#include <string_view>

#include "collided/recording.hpp"

namespace collided::cli {

/// A time in a recording: "2026-11-22T12:03:10.5Z", also with "+01:00" for Z; "1795348990.5" in seconds since 1970;
/// "+2s" after the beginning; "-2s" before the end. To the nanosecond.
///
/// throws  Failure with the option and the text
/// may_be  other allowed texts, for the Failure
RunTime parse_time(std::string_view option, std::string_view text, std::string_view may_be);

}  // namespace collided::cli
