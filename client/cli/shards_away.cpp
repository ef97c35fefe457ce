#include "client/cli/shards_away.hpp"

#include <collided/shards.hpp>
#include <fmt/format.h>

#include "client/cli/output/readable.hpp"

namespace collided::cli {

void warn_of_shards_away(Session& session, const Globals& globals, std::string_view meaning) {
  for (const ShardState& shard : session.sharded(globals).shards()) {
    if (shard.is_there) continue;
    const std::string why = shard.fault.empty() ? "it was not found yet" : printable(shard.fault);
    print_warning(session.io, fmt::format("shard '{}' is not there: {}; {}", printable(shard.name), why, meaning));
  }
}

}  // namespace collided::cli
