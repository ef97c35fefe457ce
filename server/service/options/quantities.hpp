#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace collided::engine::service {

/// Whole numbers with optional '_' between digits; nothing if the text is anything else or out of range.
std::optional<std::int64_t> parse_whole(std::string_view text);

/// Nanoseconds of "10ms", "1.5s", "200us", "2h"; the unit is required except for a plain 0.
std::optional<std::int64_t> parse_duration_ns(std::string_view text);

/// Metres per unit, from a unit's name ("mm", "m", "in", ...) or a positive number of metres.
std::optional<double> parse_unit_m(std::string_view text);

/// Metres of "1um", "0.5", "2 mm": a finite length not below 0; metres if no unit is given.
std::optional<double> parse_length_m(std::string_view text);

/// Metres of "X0,Y0,Z0:X1,Y1,Z1": the lower corner, then the upper one. Each number as in a length, but of any sign or
/// infinite.
std::optional<std::array<double, 6>> parse_box_m(std::string_view text);

/// Whether the name can begin the names of topics.
bool is_namespace(std::string_view name);
inline constexpr const char* kNamespaces = "1 to 64 letters, digits, '_' and '/', not starting with a digit";

/// Whether a word has only the letters of addresses and interfaces, so that it may become part of DDS's own
/// configuration.
bool is_network_word(std::string_view word);

/// Whether from_chars takes the whole text as a number ("-1", "-.5", "+3", "1e-300", "-inf"): it is then never an
/// option.
bool is_number(std::string_view text);

}  // namespace collided::engine::service
