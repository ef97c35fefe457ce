#pragma once

#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <collided/client.hpp>
#include <collided/diagnosis.hpp>
#include <collided/fleet.hpp>
#include <collided/recording.hpp>
#include <collided/shards.hpp>

/// A server in memory behind the symbols of collided/client.hpp: what it answers is what a test put here.
namespace collided::fake {

struct Published {
  std::string publisher;
  PublishOptions options = {};
  std::map<std::uint32_t, ObjectOptions> objects;      // by handle; removed ones are gone
  std::vector<std::map<std::uint32_t, Pose>> batches;  // one a flush
  std::map<std::uint32_t, Pose> pending;
  std::vector<std::chrono::nanoseconds> stamps = {};  // one a flush
  bool is_streamed = false;
  bool is_sharded = false;  // it publishes to several shards
};

struct Server {
  std::optional<Error> connect_error;
  ConnectOptions connected_with;
  int connect_count = 0;

  std::function<Answer(const RayQuestion&, const AskOptions&)> ray;
  std::function<Answer(const SphereQuestion&, const AskOptions&)> sphere;
  std::function<Answer(const BoxQuestion&, const AskOptions&)> box;
  std::function<Answer(const NearQuestion&, const AskOptions&)> near;
  std::function<Answer(const Shape&, const SweepQuestion&, const AskOptions&)> sweep;
  std::function<Result<std::string>(const std::string&, const nlohmann::json&, const Shape&)> command;
  std::vector<std::byte> bytes;  // that came with the last command that takes some
  std::function<Result<PairAnswer>(const std::string&, const std::string&, const PairOptions&)> pair;
  std::function<Result<ClearanceAnswer>(const std::string&, const ClearanceOptions&)> clearance;
  std::function<Result<WhatIfAnswers>(const WhatIfConfigurations&, const WhatIfOptions&)> what_if;
  std::function<Result<ShownObjects>(const ShapesOptions&)> shapes;
  std::function<Result<Poses>()> poses;
  std::vector<Probe> probes;
  std::deque<ProbeReading> readings;  // also what is followed
  WatchOptions probes_watched_with;
  std::vector<Standing> standing;
  std::vector<ListedStanding> listed_standing;
  std::uint64_t standing_parts = 0;  // parts of scenes that one that is added matches
  std::deque<StandingEvent> standing_events;
  StandingWatchOptions standing_watched_with;
  /// Called on every flush, so that a test can send events back.
  std::string lost;                                             // what each flush reports of a loss
  std::function<void(std::chrono::nanoseconds)> on_keep_alive;  // with the time that was given
  std::function<void(Published&)> on_flush;
  std::function<std::optional<Error>()> on_move;  // what stands in its way
  std::optional<Error> left_out;                  // what waiting for a publisher's samples says
  PublisherReport report;                         // of every publisher
  std::optional<Error> ask_error;

  std::string recorded_to;
  std::vector<std::pair<std::string, std::string>> own_messages;  // topic and text, written into the recording
  RecordingCounts recording;
  std::optional<Error> recording_error;  // at its end
  std::chrono::nanoseconds fetched{0};
  ReplayOptions replayed_with;
  std::deque<ReplayReport> replays;  // one a call; the last one again and again
  std::vector<Finding> findings;
  std::vector<FleetMember> members;
  std::string shard_map;  // that was connected by
  std::vector<ShardState> shards;
  std::optional<ShardedPairAnswer> sharded_pair;            // none: what one server says
  std::optional<ShardedClearanceAnswer> sharded_clearance;  // likewise
  std::uint64_t shard_gaps = 0;                             // of a watch of theirs
  std::function<Result<ShardSplitReport>(const std::string& map, const std::string& next, const ShardSplitOptions&)>
      split;
  Strangers strangers;

  std::uint64_t version = 18204;
  std::uint64_t epoch = 1;
  ServerStatus status;
  std::deque<Event> events;
  WatchOptions watched_with;
  std::chrono::nanoseconds tells_since{0};
  std::vector<Published> publishers;
  std::vector<std::size_t> request_sizes;
  AskOptions last_options;
  std::recursive_mutex mutex;
};

/// The server of the running test; reset() gives it a new one.
Server& server();
void reset();

/// A hit as the server would send it.
Hit hit(const std::string& object, double distance_m, const Vec3& point);
Answer hit_answer(std::vector<Hit> hits);

}  // namespace collided::fake
