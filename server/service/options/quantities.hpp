#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace collided::engine::service {

/// Whole numbers with optional '_' between digits; nothing where the text is anything else or out of range.
std::optional<std::int64_t> parse_whole(std::string_view text);

/// Nanoseconds of "10ms", "1.5s", "200us", "2h"; the unit is required except for a plain 0.
std::optional<std::int64_t> parse_duration_ns(std::string_view text);

/// Metres of a unit's name ("mm", "m", "in", ...) or of a positive number of metres.
std::optional<double> parse_unit_m(std::string_view text);

/// Metres of "1um", "0.5", "2 mm": a length not below 0, in metres where no unit stands.
std::optional<double> parse_length_m(std::string_view text);

/// "X0,Y0,Z0:X1,Y1,Z1": two corners, the lower one first, each number as a length above but of any sign; may be infinite.
std::optional<std::array<double, 6>> parse_box_m(std::string_view text);

/// True for what from_chars takes whole as a number ("-1", "-.5", "+3", "1e-300", "-inf"): never an option.
bool is_number(std::string_view text);

}  // namespace collided::engine::service
