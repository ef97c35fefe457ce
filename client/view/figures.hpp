#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "idl/answers/figures.hpp"

namespace collided::view {

/// Reads the command's answer; nothing where it is not as the command promises.
std::optional<Figures> parse_figures(std::string_view json);

/// What was done between two readings; up_ns is then the time between them. Where the server was restarted in between,
/// so its up_ns is less, the newer reading as it is.
Figures between(const Figures& older, const Figures& newer);

/// The duration that a fraction `part` of them (0.5: the median) does not exceed, at most an eighth too long. Nothing
/// where there are none.
std::optional<std::int64_t> quantile_ns(std::span<const DurationStep> durations, double part);

}  // namespace collided::view
