#pragma once

#include <string_view>

#include "collided/recording.hpp"

namespace collided::cli {

/// "2026-11-22T12:03:10.5Z", with "+01:00" for Z too; "1795348990.5", seconds since 1970; "+2s" from the begin on; "-2s"
/// before the end. To the nanosecond. Throws Failure naming the option and the text. may_be  what else it could have been, for the Failure
RunTime parse_time(std::string_view option, std::string_view text, std::string_view may_be);

}  // namespace collided::cli
