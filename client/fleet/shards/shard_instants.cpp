#include "client/fleet/shards/shard_instants.hpp"

#include <algorithm>
#include <future>
#include <memory>
#include <utility>

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

/// What a shard says of its own time.
struct ShardTime {
  nanoseconds time{0};
  std::uint64_t version = 0;
  bool is_at_rest = false;  // nobody publishes, so it stays as it is
};

bool is_at_rest(Client& client, std::uint64_t version) {
  const Result<ServerStatus> status = client.status();
  return status && status->version == version && std::ranges::all_of(status->publishers, &PublisherInfo::lost);
}

/// Asks every shard about a point, only to hear its time.
Result<std::vector<std::optional<ShardTime>>> times_of(const ShardLinks& links, const shards::ShardMap& map,
                                                       const AskOptions& options, Instant::Kind kind) {
  AskOptions asked{.mode = HitMode::verdict, .timeout = options.timeout, .fresh = options.fresh};
  asked.as_of.kind = kind;
  std::vector<std::shared_ptr<Client>> clients(map.size());
  std::vector<std::future<Result<Answers>>> answers(clients.size());
  for (std::size_t place = 0; place < clients.size(); ++place) {
    if ((map.all() & shards::set_of(place)) != 0) clients[place] = links.shard(place);
    if (clients[place]) answers[place] = clients[place]->ask_async(std::vector{InsideQuestion{Vec3::Zero()}}, asked);
  }
  std::vector<std::optional<ShardTime>> times(clients.size());
  std::optional<Error> refused;
  for (std::size_t place = 0; place < clients.size(); ++place) {
    if (!clients[place]) continue;
    const Result<Answers> answer = answers[place].get();
    if (!answer && !is_silence(answer.error())) refused = answer.error();
    if (!answer) continue;
    times[place] = {.time = answer->world_time,
                    .version = answer->version,
                    .is_at_rest = is_at_rest(*clients[place], answer->version)};
  }
  if (refused) return *refused;
  return times;
}

/// The earliest time of those that go on, or the latest of all where every one rests.
nanoseconds common_time(const std::vector<std::optional<ShardTime>>& times) {
  std::optional<nanoseconds> earliest;
  nanoseconds latest{0};
  for (const std::optional<ShardTime>& one : times) {
    if (!one) continue;
    latest = std::max(latest, one->time);
    if (!one->is_at_rest) earliest = std::min(one->time, earliest.value_or(one->time));
  }
  return earliest.value_or(latest);
}

}  // namespace

bool is_silence(const Error& error) {
  return error.code == ErrorCode::disconnected || error.code == ErrorCode::timeout ||
         error.code == ErrorCode::no_server;
}

Result<ShardInstants> choose_instants(const ShardLinks& links, const shards::ShardMap& map, const AskOptions& options) {
  ShardInstants chosen{.of_shard = std::vector<ShardInstants::OfShard>(map.size()), .time = {}};
  const Instant& asked = options.as_of;
  if (asked.kind == Instant::Kind::latest) return chosen;
  // Where a shard rests, its newest state is its settled one.
  const bool is_settled = asked.kind == Instant::Kind::settled;
  const auto times = times_of(links, map, options, is_settled ? Instant::Kind::settled : Instant::Kind::latest);
  if (!times) return times.error();
  nanoseconds time = asked.time;
  if (asked.kind != Instant::Kind::at) time = common_time(*times) - (is_settled ? nanoseconds(0) : asked.time);
  for (std::size_t place = 0; place < times->size(); ++place) {
    const std::optional<ShardTime>& own = (*times)[place];
    ShardInstants::OfShard& of = chosen.of_shard[place];
    of.is_there = own.has_value();
    of.instant = {.kind = Instant::Kind::at, .time = std::max(time, nanoseconds(0))};
    if (!own || !own->is_at_rest || own->time > time) continue;
    of.instant = {};
    of.version = own->version;
  }
  chosen.time = time;
  return chosen;
}

}  // namespace collided::client
