#include "client/cli/programs/fleet/fleet_of_shards.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <collided/shards.hpp>
#include <fmt/format.h>

#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

/// "-inf 0 0 .. 10 inf inf".
std::string box_text(const ShardState& shard) {
  return fmt::format("{} {} {} .. {} {} {}", shard.low.x(), shard.low.y(), shard.low.z(), shard.high.x(),
                     shard.high.y(), shard.high.z());
}

void print_table(Printer& printer, const std::vector<ShardState>& shards) {
  static const std::vector<std::string> kHeader{"SHARD", "BOX", "STATE", "OBJECTS", "TRIANGLES", "FAULT"};
  for (const ShardState& shard : shards) {
    printer.row(kHeader, {shard.name, box_text(shard), shard.is_there ? shard.state : "not there",
                          shard.is_there ? format_count(shard.objects) : "",
                          shard.is_there ? format_count(shard.static_triangles) : "", printable(shard.fault)});
  }
}

Record record(const ShardState& shard) {
  return {{"shard", shard.name},
          {"state", shard.is_there ? shard.state : std::string("not there")},
          {"objects", std::uint64_t{shard.objects}},
          {"triangles", shard.static_triangles},
          {"fault", shard.fault},
          {"namespace", shard.name_space},
          {"low", MaybeVector(shard.low)},
          {"high", MaybeVector(shard.high)}};
}

}  // namespace

Exit print_shards(Session& session, const Globals& globals) {
  const std::vector<ShardState> shards = session.sharded(globals).shards();
  Printer printer = make_printer(session.io, globals);
  printer.set_usual_fields({"shard", "state", "objects", "triangles", "fault"});
  if (printer.human()) print_table(printer, shards);
  else
    for (const ShardState& shard : shards) printer.record(record(shard));
  printer.finish();
  return std::ranges::all_of(shards, &ShardState::is_there) ? Exit::yes : Exit::no;
}

}  // namespace collided::cli
