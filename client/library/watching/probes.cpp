#include "client/library/watching/probes.hpp"

#include <algorithm>
#include <array>
#include <thread>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/wait_until.hpp"
#include "idl/columns.hpp"
#include "idl/commands.hpp"
#include "idl/glob.hpp"

namespace collided::client {
namespace {

constexpr std::chrono::seconds kTimeout{10};

bool fits(const wire::ProbeFrame& frame, std::size_t name_count) {
  return wire::has_rows<wire::ProbeFrameColumns>(frame, name_count);
}

}  // namespace

Result<void> add_probe(Connection& connection, const Probe& probe) {
  nlohmann::json arguments{{"name", probe.name},
                           {"object", probe.object},
                           {"origin", json_of(probe.origin)},
                           {"direction", json_of(probe.direction)},
                           {"back_m", probe.back_m}};
  // JSON has no infinity: a probe without reach_m has an infinite reach.
  if (!std::isinf(probe.reach_m) || probe.reach_m < 0) arguments["reach_m"] = probe.reach_m;
  return read_answer(command(connection, wire_contract::command::kProbe, arguments, kTimeout), "probe",
                     [](const nlohmann::json&) {});
}

Result<std::size_t> remove_probes(Connection& connection, const std::string& name) {
  const nlohmann::json arguments{{"name", name}, {"remove", true}};
  return read_answer(command(connection, wire_contract::command::kProbe, arguments, kTimeout), "probe",
                     [](const nlohmann::json& answer) { return answer.at("probes").size(); });
}

Result<std::vector<ProbeReading>> read_probes(Connection& connection, const std::string& name_glob) {
  const nlohmann::json arguments{{"name", name_glob}};
  const auto read = [&](const nlohmann::json& answer) {
    auto readings = from_json<std::vector<ProbeReading>>(answer.at("probes"));
    for (ProbeReading& reading : readings) {
      reading.version = answer.at("version");
      reading.world_time = std::chrono::nanoseconds(answer.at("world_time_ns").get<std::int64_t>());
    }
    return readings;
  };
  return read_answer(command(connection, wire_contract::command::kProbes, arguments, kTimeout), "probes", read);
}

bool decode(const wire::ProbeFrame& frame, Names& names, std::vector<ProbeReading>& readings) {
  const std::vector<std::string_view> probes = wire_contract::unpack_names(dds::view(frame.probe_names));
  if (!fits(frame, probes.size())) { return false; }
  names.learn(dds::view(frame.named_ids), dds::view(frame.names));
  const auto name = [&](std::uint64_t id) { return id == 0 ? std::string() : names.name(id); };
  for (std::size_t i = 0; i < probes.size(); ++i) {
    ProbeReading& reading = readings.emplace_back();
    wire::take_row(frame, i, reading);
    if (!codes::is_known<Clearance>(dds::view(frame.states)[i])) reading.state = Clearance::undecided;
    reading.probe = probes[i];
    reading.object = name(dds::view(frame.objects)[i]);
    reading.error_m = dds::view(frame.clearance_errors)[i];
    reading.met = name(dds::view(frame.met)[i]);
    reading.epoch = frame.epoch;
    reading.version = frame.version;
    reading.world_time = std::chrono::nanoseconds(frame.world_time_ns);
  }
  return true;
}

ProbeReader::ProbeReader(std::shared_ptr<Connection> connection, const WatchOptions& options)
    : connection_(std::move(connection)),
      options_(options),
      topic_(connection_->participant(), connection_->options().name_space) {
  using Frames = dds::Taker<wire::ProbeFrame>;
  reader_.emplace(topic_, dds::ReaderOptions<wire::ProbeFrame>{.data = [this](Frames) { take(); }});
  has_reader_.store(true);
  take();
}

Result<std::unique_ptr<ProbeReader>> ProbeReader::start(std::shared_ptr<Connection> connection,
                                                        const WatchOptions& options) {
  try {
    std::unique_ptr<ProbeReader> reader(new ProbeReader(std::move(connection), options));
    const Clock::time_point deadline = Clock::now() + reader->connection_->options().wait;
    const auto is_offered = [&] { return reader->reader_->matched_writers() > 0; };
    if (wait_until(deadline, is_offered)) return reader;
    if (reader->connection_->pulse().silent()) return reader->connection_->disconnected();
    return Error{ErrorCode::no_server, "probes: the server offers no readings", ""};
  } catch (const dds::DdsError& failed) { return failure_of(failed); }
}

/// A callback that runs before its reader exists leaves the samples in it.
void ProbeReader::take() {
  if (!has_reader_.load()) return;
  const std::lock_guard one(taking_mutex_);
  while (reader_->take(incoming_)) {
    decoded_.clear();
    const dds_sample_info_t& info = incoming_.info();
    if (!info.valid_data || !connection_->is_from_server(*reader_, info, incoming_->server)) continue;
    if (incoming_->epoch < connection_->pulse().epoch())
      continue;  // from an earlier server, which was suspended and resumed
    if (!decode(*incoming_, connection_->names(), decoded_)) { continue; }
    const std::lock_guard lock(mutex_);
    for (ProbeReading& reading : decoded_) {
      const bool asked = options_.only.empty() || wire_contract::glob_matches(options_.only, reading.probe);
      const bool skipped = !options_.skip.empty() && wire_contract::glob_matches(options_.skip, reading.probe);
      if (!asked || skipped) { continue; }
      if (readings_.size() >= std::max<std::size_t>(options_.capacity, 1)) {
        readings_.pop_front();
        ++lost_;
      }
      readings_.push_back(std::move(reading));
    }
    came_.notify_all();
  }
}

std::optional<ProbeReading> ProbeReader::next(std::chrono::nanoseconds wait) {
  std::unique_lock lock(mutex_);
  // An infinite wait would overflow the clock, so it is limited to a year.
  const auto most = std::min<std::chrono::nanoseconds>(wait, std::chrono::hours(24 * 365));
  if (!came_.wait_until(lock, Clock::now() + most, [this] { return !readings_.empty(); })) { return std::nullopt; }
  ProbeReading reading = std::move(readings_.front());
  readings_.pop_front();
  return reading;
}

}  // namespace collided::client
