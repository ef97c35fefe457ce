#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/margins.hpp"

namespace collided {

namespace client {

/// Client::add_margin, remove_margins and margins.
Result<AddedMargin> add_margin(Connection& connection, const Margin& margin);
Result<std::size_t> remove_margins(Connection& connection, const std::string& name);
Result<std::vector<ListedMargin>> list_margins(Connection& connection, const std::string& name_glob);

/// Whether the name that an event gives for a fence is that of a margin's band.
inline bool is_band_name(std::string_view fence) { return fence.find('\n') != std::string_view::npos; }

/// What an event of the fences' topics says of a margin; nothing: it is about a fence, or not wanted.
std::optional<MarginEvent> margin_news(const Event& event, const MarginWatchOptions& wanted);

}  // namespace client

}  // namespace collided
