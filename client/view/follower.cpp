#include "client/view/follower.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "idl/commands.hpp"

namespace collided::view {
namespace {

constexpr std::size_t kMostEventsAtOnce = 4'096;

}  // namespace

Result<std::unique_ptr<Follower>> Follower::start(Client& client, Observer& observer, FollowOptions options) {
  Result<Watch> watch = client.watch();
  if (!watch) return watch.error();
  return std::unique_ptr<Follower>(new Follower(client, std::move(*watch), observer, std::move(options)));
}

Follower::Follower(Client& client, Watch watch, Observer& observer, FollowOptions options)
    : client_(client),
      watch_(std::move(watch)),
      observer_(observer),
      options_(std::move(options)),
      standing_(client),
      heard_(Clock::now()) {
  looking_ = std::thread([this] { look(); });
  listening_ = std::thread([this] { listen(); });
}

Follower::~Follower() {
  stopping_.store(true);
  looking_.join();
  listening_.join();
}

void Follower::look() {
  Clock::time_point due = Clock::now();
  while (!stopping_.load()) {
    if (options_.is_watched()) {
      look_at_poses();
      if (Clock::now() >= next_standing_) look_at_standing();
    }
    if (Clock::now() >= next_status_) look_at_status();
    // After a late frame the next ones still come one period apart.
    due = std::max(due + options_.frame, Clock::now());
    std::this_thread::sleep_until(std::min(due, Clock::now() + options_.frame));
  }
}

void Follower::look_at_poses() {
  const Result<Poses> poses = client_.poses();
  if (!poses) return;
  heard_.note(Clock::now());
  look_at_objects(*poses);
  if (poses->version == reported_version_ && poses->epoch == reported_epoch_) return;
  reported_version_ = poses->version;
  reported_epoch_ = poses->epoch;
  observer_.poses(*poses);
}

/// Fetches the objects again when they have changed. If objects come and go all the time, at most half of the time is
/// spent on that.
void Follower::look_at_objects(const Poses& poses) {
  const bool is_known = shown_ && shown_->epoch == poses.epoch && shown_->table_version == poses.table_version;
  const Clock::time_point start = Clock::now();
  if (is_known || start < next_objects_) return;
  const ShownObjects* earlier = shown_ && shown_->epoch == poses.epoch ? shown_.get() : nullptr;
  Result<ShownObjects> shown = client_.shapes({}, earlier);
  constexpr std::chrono::milliseconds kLeastPause{100};
  next_objects_ = Clock::now() + std::max<Clock::duration>(kLeastPause, Clock::now() - start);
  if (!shown) return;
  shown_ = std::make_shared<const ShownObjects>(std::move(*shown));
  observer_.objects(shown_);
}

void Follower::look_at_standing() {
  next_standing_ = Clock::now() + options_.standing;
  if (const auto others = standing_.look()) observer_.standing(*others);
}

void Follower::look_at_status() {
  next_status_ = Clock::now() + options_.status;
  const Result<ServerStatus> status = client_.status();
  const Clock::time_point now = Clock::now();
  if (status) heard_.note(now - status->age);
  const std::optional<double> silence_s = heard_.silence_s(now);
  if (silence_s) return observer_.silent(*silence_s);
  if (!status) return;
  const Result<std::string> text = client_.command(wire_contract::command::kFigures, "{}", {}, std::chrono::seconds(1));
  const std::optional<Figures> figures = text ? parse_figures(*text) : std::nullopt;
  const std::optional<Figures> before = std::exchange(figures_, figures);
  observer_.totals(*status, figures);
  observer_.status(*status, before && figures ? std::optional(between(*before, *figures)) : std::nullopt);
}

void Follower::listen() {
  constexpr std::chrono::milliseconds kLook{50};
  std::vector<Event> events;
  while (!stopping_.load()) {
    events.clear();
    for (std::optional<Event> event = watch_.next(kLook); event; event = watch_.next(std::chrono::nanoseconds(0))) {
      events.push_back(std::move(*event));
      if (events.size() == kMostEventsAtOnce) break;
    }
    if (!events.empty()) observer_.events(events);
  }
}

}  // namespace collided::view
