#pragma once

#include <optional>
#include <string_view>

#include "collided/margins.hpp"

namespace collided::client {

/// Whether the name that an event gives for a fence is that of a margin's band.
inline bool is_band_name(std::string_view fence) { return fence.find('\n') != std::string_view::npos; }

/// What an event of the fences' topics says of a margin; nothing: it is about a fence, or not wanted.
std::optional<MarginEvent> margin_news(const Event& event, const MarginWatchOptions& wanted);

}  // namespace collided::client
