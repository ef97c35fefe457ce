#include "client/cli/programs/fleet/fleet_split.hpp"

#include <string>

#include <collided/shards.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/readable.hpp"
#include "idl/shards/shard_map_source.hpp"

namespace collided::cli {

Exit split_shards(Session& session, const Globals& globals, const FleetSplitOptions& options) {
  const bool is_next_named = !options.to.empty() || shards::is_in_etcd(globals.shards);
  if (globals.shards.empty() || !is_next_named)
    throw bad_use("which maps?", "collide fleet split --shards MAP --to MAP: the map that holds, and the one after it");
  ShardSplitOptions how{.undo = options.undo,
                        .said = [&](const std::string& said) { print_hint(session.io, globals, said); }};
  how.patience = options.patience.value_or(how.patience);
  const ShardSplitReport report =
      take(split_shard(globals.shards, options.to, connect_options(session.io, globals), how));
  Printer printer = make_printer(session.io, globals);
  printer.set_usual_fields({"shard", "into", "objects", "watches"});
  if (!printer.human()) {
    printer.record({{"shard", report.shard},
                    {"into", RawJson{nlohmann::json(report.into).dump()}},
                    {"objects", report.objects},
                    {"watches", std::uint64_t{report.watches}},
                    {"undone", options.undo},
                    {"seconds", std::chrono::duration<double>(report.took).count()}});
  } else if (options.undo) {
    printer.line(fmt::format("{} is not split", report.shard));
  } else {
    printer.line(
        fmt::format("{} is split into {}; its server may be stopped", report.shard, fmt::join(report.into, ", ")));
    printer.line(fmt::format("{}, {}, in {}", counted(report.objects, "object"),
                             counted(report.watches, "watching client"), format_duration(report.took)));
  }
  printer.finish();
  return Exit::yes;
}

}  // namespace collided::cli
