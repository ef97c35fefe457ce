#include "client/cli/programs/fleet/fleet_publish.hpp"

#include <cstdint>

#include <fmt/format.h>

#include "client/cli/programs/fleet/kept_maps.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "idl/shards/shard_map_source.hpp"

namespace collided::cli {

Exit publish_map(Session& session, const Globals& globals, const FleetPublishOptions& options) {
  if (globals.shards.empty() || !shards::is_in_etcd(options.to))
    throw bad_use("which map, and where to?",
                  "collide fleet publish --shards FILE --to etcd://HOST:PORT/KEY: servers and clients read it there");
  const shards::MapAccess access = map_access(session.io, globals);
  const shards::ShardMap map = take_map(globals.shards, access).map;
  const std::int64_t revision =
      write_map(map, options.to, static_cast<std::int64_t>(options.revision.value_or(0)), access);
  Printer printer = make_printer(session.io, globals);
  printer.set_usual_fields({"map", "shards", "revision"});
  if (printer.human())
    printer.line(fmt::format("{} has {}, revision {}", options.to, counted(map.size(), "shard"), revision));
  else
    printer.record({{"map", options.to},
                    {"shards", std::uint64_t{map.size()}},
                    {"revision", static_cast<std::uint64_t>(revision)}});
  printer.finish();
  return Exit::yes;
}

}  // namespace collided::cli
