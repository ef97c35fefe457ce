#pragma once

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/service/endurance/measuring.hpp"

namespace collided::testing_support {

using NamedPair = std::pair<std::string, std::string>;

/// Balls of a publisher that jump about in a small room, and which of them touch.
class MovingCrowd {
 public:
  static constexpr int kBalls = 12;
  static constexpr double kRadius_m = 0.5;

  MovingCrowd(Client& client, std::uint64_t seed, const std::string& name = "ball")
      : random_(seed), name_(name), publisher_(value_of(client.publish(name), "publish")) {
    for (int i = 0; i < kBalls; ++i) {
      positions_.emplace_back(100.0 + 10 * i, 0, 0);
      balls_.push_back(value_of(publisher_.add({.name = name_of(i),
                                                .shape = {SphereShape{.radius_m = kRadius_m}},
                                                .pose = {.position = positions_.back()}}),
                                "add"));
    }
  }
  /// False where the server took nothing.
  bool move_all() { return move_first(kBalls); }
  /// The others rest.
  bool move_first(int count) {
    std::uniform_real_distribution<double> coordinate(0, 3);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      positions_[i] = Vec3(100 + coordinate(random_), coordinate(random_), coordinate(random_));
      static_cast<void>(publisher_.move(balls_[i], {.position = positions_[i]}));
    }
    return publisher_.flush().operator bool();
  }
  bool keep_alive() { return publisher_.keep_alive().operator bool(); }
  bool flush() { return publisher_.flush().operator bool(); }
  /// Nothing is on the border: a distance of exactly two radii has no chance here.
  std::set<NamedPair> touching() const {
    std::set<NamedPair> pairs;
    for (int i = 0; i < kBalls; ++i) {
      for (int j = i + 1; j < kBalls; ++j) {
        const double distance =
            (positions_[static_cast<std::size_t>(i)] - positions_[static_cast<std::size_t>(j)]).norm();
        if (distance <= 2 * kRadius_m) pairs.insert(std::minmax(name_of(i), name_of(j)));
      }
    }
    return pairs;
  }

 private:
  std::string name_of(int i) const { return name_ + " " + std::to_string(i); }

  std::mt19937_64 random_;
  std::string name_;
  Publisher publisher_;
  std::vector<Publisher::Object> balls_;
  std::vector<Vec3> positions_;
};

/// What a subscriber was told, and whether it made sense.
class Bookkeeper {
 public:
  explicit Bookkeeper(Client& client) {
    Watch watch = value_of(client.watch({}, [this](const Event& event) { hear(event); }), "watch");
    const std::lock_guard lock(mutex_);
    watch_.emplace(std::move(watch));
  }

  bool holds(const std::set<NamedPair>& truth) {
    const std::lock_guard lock(mutex_);
    return open_ == truth;
  }
  /// Pairs that it holds and should not, or should and does not.
  int differences(const std::set<NamedPair>& truth) {
    const std::lock_guard lock(mutex_);
    std::vector<NamedPair> differing;
    std::set_symmetric_difference(open_.begin(), open_.end(), truth.begin(), truth.end(),
                                  std::back_inserter(differing));
    return static_cast<int>(differing.size());
  }
  /// Began while it held, or ended while it did not, since the last call.
  int take_unpaired() {
    const std::lock_guard lock(mutex_);
    return std::exchange(unpaired_, 0);
  }
  /// Gaps in the sequence of which the watch did not know, since the last call; some time after the last event.
  int take_undetected_gaps() {
    const std::lock_guard lock(mutex_);
    int undetected = 0;
    for (const std::uint64_t resyncs_before : gaps_) undetected += watch_->resyncs() > resyncs_before ? 0 : 1;
    gaps_.clear();
    return undetected;
  }
  std::uint64_t resyncs() const { return watch_->resyncs(); }
  bool connected() const { return watch_->connected(); }

 private:
  void hear(const Event& event) {
    const std::lock_guard lock(mutex_);
    const NamedPair pair = std::minmax(event.a, event.b);
    unpaired_ += (event.kind == EventKind::ended ? open_.erase(pair) == 1 : open_.insert(pair).second) ? 0 : 1;
    const bool follows =
        event.resync || event.kind == EventKind::open || event.epoch != epoch_ || event.sequence <= sequence_ + 1;
    if (!follows) gaps_.push_back(resyncs_seen_);
    sequence_ = event.epoch == epoch_ ? std::max(sequence_, event.sequence) : event.sequence;
    epoch_ = event.epoch;
    if (watch_) resyncs_seen_ = watch_->resyncs();
  }

  std::mutex mutex_;
  std::set<NamedPair> open_;
  int unpaired_ = 0;
  std::uint64_t epoch_ = 0;
  std::uint64_t sequence_ = 0;
  std::uint64_t resyncs_seen_ = 0;  // as of the last event, at most
  std::vector<std::uint64_t> gaps_;
  std::optional<Watch> watch_;  // calls hear() before it is in its place
};

}  // namespace collided::testing_support
