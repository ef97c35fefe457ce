#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/library/connection/errors.hpp"
#include "client/fleet/shards/split_maps.hpp"
#include "collided/shards.hpp"
#include "idl/commands.hpp"
#include "idl/shards/shard_map.hpp"
#include "idl/shards/shard_split.hpp"

namespace collided {
namespace client {
namespace {

using nlohmann::json;
using shards::MapSuccession;
using shards::ShardMap;
using shards::SuccessionPhase;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
namespace names = wire_contract::command;

/// Within this every client that is there has heard that a split has begun: it asks one of the shards once a second. Those
/// that only publish, or only ask, nobody counts.
constexpr nanoseconds kBeginHeard = seconds(3);
/// And from then on every further step, since it asks five times a second.
constexpr nanoseconds kStepHeard = seconds(1);
constexpr nanoseconds kLook = milliseconds(500);
constexpr nanoseconds kAnswerWait = seconds(10);
constexpr std::uint64_t kMostListed = 1'000'000;

/// One of the servers of both maps.
struct SplitServer {
  std::string shard;
  Client client;
};

struct ObjectInShard {
  shards::ShardBox bounds;
  std::string attached_to;
};

/// A refusal or a silence, in words of the shard.
Error of_shard(const SplitServer& server, Error error) {
  error.message = "shard '" + server.shard + "': " + error.message;
  return error;
}

Result<json> ask(SplitServer& server, const char* command, const json& arguments) {
  const Result<std::string> answer = server.client.command(command, arguments.dump(), {}, kAnswerWait);
  if (!answer) return of_shard(server, answer.error());
  json said = json::parse(*answer, nullptr, false);
  if (!said.is_object()) return of_shard(server, {ErrorCode::refused, "its answer is no JSON object", ""});
  return said;
}

/// null in the place of a number is endless.
shards::ShardBox bounds_of(const json& bounds) {
  shards::ShardBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const json& low = bounds.at(0).at(axis);
    const json& high = bounds.at(1).at(axis);
    box.low[axis] = low.is_number() ? low.get<double>() : -std::numeric_limits<double>::infinity();
    box.high[axis] = high.is_number() ? high.get<double>() : std::numeric_limits<double>::infinity();
  }
  return box;
}

using Listed = std::map<std::string, ObjectInShard>;

Result<Listed> listed(SplitServer& server) {
  Result<json> answer = ask(server, names::kList, {{"bounds", true}, {"limit", kMostListed}});
  if (!answer) return answer.error();
  Listed objects;
  for (const json& object : answer->value("objects", json::array())) {
    const auto bounds = object.find("bounds");
    if (bounds == object.end() || !bounds->is_array()) continue;
    objects.emplace(
        object.value("name", std::string()),
        ObjectInShard{.bounds = bounds_of(*bounds), .attached_to = object.value("attached_to", std::string())});
  }
  return objects;
}

/// Coordinates a split. It keeps nothing of its own: what it has told the servers says how far it has come, so another one
/// goes on where it ended.
class SplitCoordinator {
 public:
  SplitCoordinator(SplitMaps maps, const ConnectOptions& options, const ShardSplitOptions& how)
      : maps_(std::move(maps)), split_(shards::split_between(map_, next_)), options_(options), how_(how) {}

  Result<ShardSplitReport> run() {
    const auto started = std::chrono::steady_clock::now();
    if (auto error = connect()) return *error;
    if (auto error = find_out()) return *error;
    if (how_.undo) {
      if (auto error = undo()) return *error;
    } else if (auto error = carry_out()) {
      return *error;
    }
    report_.took = std::chrono::steady_clock::now() - started;
    return report_;
  }

 private:
  const std::string& from_name() const { return map_.at(split_.from).name; }
  void say(const std::string& sentence) const {
    if (how_.said) how_.said(sentence);
  }

  std::optional<Error> connect() {
    std::vector<std::string> wanted;
    for (std::size_t place = 0; place < map_.size(); ++place) wanted.push_back(map_.at(place).name);
    for (const std::size_t place : split_.into) wanted.push_back(next_.at(place).name);
    report_.shard = from_name();
    for (const std::string& name : wanted) {
      ConnectOptions options = options_;
      options.name_space = shards::shard_namespace(options_.name_space, name);
      options.replicas = false;
      Result<Client> client = Client::connect(options);
      if (!client) {
        Error error = client.error();
        error.message = "shard '" + name + "' is not there: " + error.message + ". Nothing was changed";
        error.hint = map_.find(name) ? "all shards must be there while one is split"
                                     : "start it with 'collided --shard MAP:NAME' and the next map";
        return error;
      }
      servers_.push_back({.shard = name, .client = std::move(*client)});
      if (!map_.find(name)) report_.into.push_back(name);
    }
    return std::nullopt;
  }

  /// Which phase the servers are in, by the newest that one of them says.
  std::optional<Error> find_out() {
    for (SplitServer& server : servers_) {
      Result<json> said = ask(server, names::kShard, json::object());
      if (!said) return said.error();
      const auto map = shards::fingerprint_of(said->value("map", std::string()));
      std::optional<MapSuccession> succession;
      try {
        if (said->contains("succession")) succession = shards::parse_succession((*said)["succession"].dump());
      } catch (const shards::ShardMapError& wrong) { return of_shard(server, {ErrorCode::refused, wrong.what(), ""}); }
      if (succession) revision_ = std::max(revision_, succession->revision);
      const bool is_ours =
          succession && succession->from == map_.fingerprint() && succession->next.fingerprint() == next_.fingerprint();
      const bool came_before = succession && succession->next.fingerprint() == map_.fingerprint() &&
                               succession->phase == SuccessionPhase::done;
      if (is_ours && (!phase_ || succession->revision > phase_revision_)) {
        phase_ = succession->phase;
        phase_revision_ = succession->revision;
      }
      const std::uint64_t due = map_.find(server.shard) ? map_.fingerprint() : next_.fingerprint();
      // A server that was started again has the next map's file by now.
      const bool fits = map == due || map == next_.fingerprint() || is_ours || came_before;
      if (!fits)
        return of_shard(server, {ErrorCode::refused,
                                 "it is of map " + shards::fingerprint_text(map.value_or(0)) + ", not of " +
                                     shards::fingerprint_text(due) + ". Nothing was changed",
                                 "give the files that the servers were started with"});
    }
    return std::nullopt;
  }

  /// Error: of the first one that could not be told, or refuses it.
  std::optional<Error> tell(SuccessionPhase phase) {
    const MapSuccession said{.revision = ++revision_, .phase = phase, .from = map_.fingerprint(), .next = next_};
    const std::string text = shards::succession_text(said);
    // One that cannot be told keeps nobody else from hearing it.
    std::optional<Error> failed;
    for (SplitServer& server : servers_) {
      auto told = ask(server, names::kSuccession, json::parse(text));
      if (!told && !failed) failed = told.error();
    }
    return failed;
  }

  std::optional<Error> undo() {
    if (maps_.is_swapped() || phase_ == SuccessionPhase::in_force || phase_ == SuccessionPhase::done)
      return Error{ErrorCode::refused, "the next map holds already: the split goes on, not back",
                   "run it again without undo"};
    if (auto error = maps_.keep()) return error;
    if (auto error = tell(SuccessionPhase::withdrawn)) return error;
    say("all is as before");
    return std::nullopt;
  }

  std::optional<Error> carry_out() {
    const bool is_begun = phase_ == SuccessionPhase::in_force || phase_ == SuccessionPhase::done;
    if (!is_begun) {
      if (auto error = join()) return error;
    }
    if (auto error = swap(is_begun)) return error;
    if (phase_ != SuccessionPhase::done) {
      say("the next map holds: questions go to the new shards");
      if (auto error = tell(SuccessionPhase::in_force)) return error;
      std::this_thread::sleep_for(kStepHeard);
    }
    // First the one that is over: from then on it covers nothing, and only then do publishers leave it.
    std::ranges::stable_partition(servers_, [&](const SplitServer& server) { return server.shard == from_name(); });
    if (auto error = tell(SuccessionPhase::done)) return error;
    say("'" + from_name() + "' holds nothing any more");
    std::this_thread::sleep_for(kStepHeard);
    return std::nullopt;
  }

  /// Has etcd say which map holds, where that is where the maps are. Until it has, nobody goes by the next one.
  std::optional<Error> swap(bool is_begun) {
    std::optional<Error> failed = maps_.swap();
    if (!failed || is_begun) return failed;
    if (failed->code == ErrorCode::refused) return take_back(std::move(*failed));
    failed->message += ". Whether the next map is there is not known, so nothing was taken back";
    failed->hint = "run it again, or with undo";
    return failed;
  }

  Error take_back(Error failed) {
    failed.message += tell(SuccessionPhase::withdrawn) ? ". It is not taken back everywhere: run it again with undo"
                                                       : ". It was taken back: all is as before";
    return failed;
  }

  /// Until the new shards hold what the old one holds, and every watch watches them. Where that does not come about in time,
  /// it is taken back.
  std::optional<Error> join() {
    std::optional<Error> failed = tell(SuccessionPhase::joining);
    if (!failed) {
      say("publishers and watches take part in the new shards");
      const auto deadline = std::chrono::steady_clock::now() + std::max(how_.patience, kBeginHeard);
      std::this_thread::sleep_for(kBeginHeard);
      while (true) {
        Result<std::string> missing = what_is_missing();
        if (missing && missing->empty()) return std::nullopt;
        if (!missing || std::chrono::steady_clock::now() > deadline) {
          failed = missing ? Error{ErrorCode::timeout, *missing, ""} : missing.error();
          break;
        }
        std::this_thread::sleep_for(kLook);
      }
    }
    return take_back(std::move(*failed));
  }

  /// The first thing that the new shards lack; empty: nothing.
  Result<std::string> what_is_missing() {
    SplitServer& old = *std::ranges::find(servers_, from_name(), &SplitServer::shard);
    Result<json> said = ask(old, names::kShard, json::object());
    if (!said) return said.error();
    report_.watches = said->value("watches", std::size_t{0});
    const std::size_t behind = said->value("watches_behind", std::size_t{0});
    if (behind > 0) return std::to_string(behind) + " watches do not watch the new shards yet";
    Result<json> rules = ask(old, names::kAllowed, json::object());
    if (!rules) return rules.error();
    const Result<Listed> objects = listed(old);
    if (!objects) return objects.error();
    report_.objects = objects->size();
    for (SplitServer& server : servers_) {
      const auto place = next_.find(server.shard);
      if (map_.find(server.shard) || !place) continue;
      Result<json> own_rules = ask(server, names::kAllowed, json::object());
      if (!own_rules) return own_rules.error();
      if ((*own_rules)["rules"] != (*rules)["rules"])
        return "the rules of which pairs may touch are others in '" + server.shard + "' than in '" + from_name() + "'";
      const Result<Listed> own = listed(server);
      if (!own) return own.error();
      std::string missing = missing_in(server.shard, next_.at(*place).box, *objects, *own);
      if (!missing.empty()) return missing;
    }
    return std::string();
  }

  static std::string missing_in(const std::string& shard, const shards::ShardBox& box, const Listed& objects,
                                const Listed& own) {
    std::size_t count = 0;
    std::string first;
    for (const auto& [name, object] : objects) {
      if (!shards::meet(object.bounds, box)) continue;
      const auto there = own.find(name);
      if (there != own.end() && there->second.attached_to != object.attached_to)
        return "'" + name + "' is attached otherwise in '" + shard + "'";
      if (there != own.end()) continue;
      if (count++ == 0) first = name;
    }
    if (count == 0) return {};
    return std::to_string(count) + (count == 1 ? " object is" : " objects are") + " missing in '" + shard + "', '" +
           first + "' among them";
  }

  SplitMaps maps_;
  const ShardMap& map_ = maps_.map();
  const ShardMap& next_ = maps_.next();
  const shards::ShardSplit split_;
  const ConnectOptions& options_;
  const ShardSplitOptions& how_;
  std::vector<SplitServer> servers_;
  std::optional<SuccessionPhase> phase_;  // of this split; none: nobody knows of it
  std::uint64_t phase_revision_ = 0;
  std::uint64_t revision_ = 0;  // the newest of any split
  ShardSplitReport report_;
};

}  // namespace
}  // namespace client

Result<ShardSplitReport> split_shard(const std::string& map, const std::string& next, const ConnectOptions& options,
                                     const ShardSplitOptions& how) {
  Result<client::SplitMaps> maps = client::SplitMaps::read(map, next, options);
  if (!maps) return maps.error();
  try {
    return client::SplitCoordinator(std::move(*maps), options, how).run();
  } catch (const shards::ShardMapError& wrong) { return client::bad_input(wrong.what()); }
}

}  // namespace collided
