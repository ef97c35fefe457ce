#pragma once

#include <optional>

#include "client/library/connection/names.hpp"
#include "client/library/watching/watch_state.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// Decodes a message; nothing where its columns differ in length or a code is unknown. It then counts as lost.
std::optional<HeardFrame> decode(const wire::EventFrame& frame, Names& names);
std::optional<HeardShard> decode(const wire::ContactShard& shard, Names& names);
HeardBookmark decode(const wire::Status& status);

}  // namespace collided::client
