#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "idl/answers/figures.hpp"

namespace collided::view {

/// Reads the command's answer; nothing if it does not have the command's format.
std::optional<Figures> parse_figures(std::string_view json);

/// The activity between two readings; up_ns is then the time between them. If the server was restarted in between, so
/// its up_ns is less, the newer reading unchanged.
Figures between(const Figures& older, const Figures& newer);

/// The duration that a fraction `part` of them (0.5: the median) does not exceed, at most an eighth too long. Nothing
/// if there are none.
std::optional<std::int64_t> quantile_ns(std::span<const DurationStep> durations, double part);

}  // namespace collided::view
