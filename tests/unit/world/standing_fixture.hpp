#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "idl/topics.hpp"
#include "server/world/fences/fences.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

struct AddOptions {
  std::uint64_t publisher = 1;  // 0: the server's own
  LostPolicy lost = LostPolicy::remove;
  std::uint32_t layers = 1;
  bool moving = true;
};
struct PoseOptions {
  std::uint64_t publisher = 1;
  bool teleport = false;
};

/// A world whose fences, margins and nearest report events as lines. Times are seconds since its start.
class StandingTest : public testing::Test {
 protected:
  using Lines = std::vector<std::string>;
  static constexpr std::int64_t kSecond_ns = 1'000'000'000;
  static constexpr AddOptions kStill{.publisher = 0, .moving = false};

  explicit StandingTest(std::int64_t gap_ns = wire_contract::kMostGapNs) : gap_ns_(gap_ns) { step(); }

  static Shape ball(double radius_m) {
    Shape shape;
    shape.primitives.emplace_back(Sphere{Vec3::Zero(), radius_m});
    return shape;
  }
  static Shape box(const Vec3& half_m, const Vec3& center = Vec3::Zero()) {
    Shape shape;
    shape.primitives.emplace_back(Box{.center = center, .half_m = half_m});
    return shape;
  }

  ObjectId add(const std::string& name, const Shape& shape, const Vec3& at, const AddOptions& options = {}) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape;
    definition.pose.position = at;
    definition.publisher = options.publisher;
    definition.moving = options.moving;
    definition.lost_policy = options.lost;
    definition.filter.layers = options.layers;
    definition.filter.group = 1;  // groups matter to contacts alone
    world_.set_gap(options.publisher, gap_ns_);
    return std::get<ObjectId>(world_.define(definition));
  }
  /// Adds an object whose publisher has a pose of it at the start.
  ObjectId start(const std::string& name, const Shape& shape, const Vec3& at, const AddOptions& options = {}) {
    const ObjectId object = add(name, shape, at, options);
    pose(object, at, 0, {.publisher = options.publisher});
    return object;
  }

  /// Why the definition is refused; empty: it was added.
  std::string refusal(const FenceDefinition& definition) {
    const auto added = world_.add_fence(definition);
    return std::holds_alternative<Refusal>(added) ? std::get<Refusal>(added).reason : std::string();
  }

  void pose(ObjectId object, const Vec3& at, double time_s, const PoseOptions& options = {}) {
    const ObjectId ids[] = {object};
    const Pose poses[] = {{.position = at}};
    bool moved[1];
    world_.move(ids, poses, time_ns(time_s), options.teleport, moved);
    EXPECT_TRUE(moved[0]);
    world_.advance(options.publisher, time_ns(time_s));
  }

  /// The events of a step: "began drone dock", "ended drone dock removed", "began drone person 2" for a band of 2 m,
  /// "ended lamp near goes on" where another object is nearest from then on.
  Lines step() {
    EXPECT_TRUE(world_.step(now_ns_ += 1'000, 1, {}));
    Lines lines;
    if (world_.fences() == nullptr) return lines;
    for (const Event& event : world_.fences()->events()) {
      const ObjectInfo* info = world_.info(event.of.a);
      std::string line = event.kind == EventKind::began ? "began " : "ended ";
      line += (info != nullptr ? info->name : "?") + " " + place_of(world_.fences()->table().name(slot_of(event.of.b)));
      if (event.kind == EventKind::ended && event.joins_next) line += " goes on";
      const std::string reason(codes::name_of(event.reason));
      if (!reason.empty() && event.reason != EndReason::separated) line += " " + reason;
      if (event.of.doubt != Doubt::none) line += " in doubt";
      lines.push_back(line);
    }
    return lines;
  }
  /// A step at that time of the server's clock.
  Lines step_at(double time_s) {
    now_ns_ = time_ns(time_s);
    return step();
  }
  Lines step_with(ObjectId object, const Vec3& at, double time_s, const PoseOptions& options = {}) {
    pose(object, at, time_s, options);
    return step();
  }

  /// Nanoseconds since the start between which event number i of the last step happened.
  std::pair<std::int64_t, std::int64_t> bracket(std::size_t i) const {
    const Event& event = world_.fences()->events().at(i);
    const auto since_start = [&](double ago_s) { return now_ns_ - kStart_ns - std::llround(ago_s * 1e9); };
    return {since_start(event.bracket_low_s), since_start(event.bracket_high_s)};
  }
  void expect_at(std::size_t i, double time_s) const {
    const auto [low_ns, high_ns] = bracket(i);
    EXPECT_LE(low_ns, time_s * 1e9);
    EXPECT_GE(high_ns, time_s * 1e9);
    EXPECT_LE(high_ns - low_ns, 10);
  }

  static std::int64_t time_ns(double time_s) { return kStart_ns + std::llround(time_s * 1e9); }

  World world_{WorldOptions{}};

 private:
  static constexpr std::int64_t kStart_ns = 1'000 * kSecond_ns;

  /// A fence's name; for a band, whose name has four lines, the object that has it and its distance.
  static std::string place_of(const std::string& fence) {
    Lines parts{""};
    for (const char c : fence) {
      if (c == '\n') parts.emplace_back();
      else parts.back() += c;
    }
    return parts.size() == 4 ? parts[1] + " " + parts[3] : fence;
  }

  std::int64_t gap_ns_;
  std::int64_t now_ns_ = kStart_ns;
};

}  // namespace collided::engine
