#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/model/plain_publishers.hpp"
#include "tests/model/random_world.hpp"
#include "tests/oracle/seed.hpp"

// One world with its publishers, told definitions and poses late, twice, out of turn and from lives that are over, beside
// plain maps of who owns what.
namespace collided::model {
using namespace engine;
namespace {

using service::Applied;
using service::DefinitionSample;
using service::PoseSample;
using service::Publishers;
using service::WriterKind;

int operations_asked() {
  const char* asked = std::getenv("COLLIDED_TWIN_OPERATIONS");
  return asked != nullptr ? std::atoi(asked) : 5'000;
}

class PublishersTwin : public testing::Test {
 protected:
  static constexpr std::uint64_t kPublishers = 3;
  static constexpr int kNumbers = 4;
  struct Sender {
    std::uint64_t incarnation = 1, sequence = 0, last_definition = 0;
    std::vector<DefinitionSample> definitions;  // sent before, of all its lives
    std::vector<PoseSample> poses;
  };

  std::string name() { return make_.one_of(std::vector<std::string>{"ape", "bat", "cat", "cow", "dog"}); }
  std::array<double, 7> pose() {
    return {make_.uniform(-9, 9), make_.uniform(-9, 9), make_.uniform(-9, 9), 0, 1, 0, 0};
  }

  void step() {
    ASSERT_TRUE(world_.step(++now_ns_, 1, {}));
    publishers_.stepped();
  }
  template <class Offer>
  void offer(Offer&& once) {
    while (once() == Applied::step_first) step();
    while (publishers_.release_parked(now_ns_) == Applied::step_first) step();
  }
  void send(DefinitionSample sample) {
    plain_.define(sample, now_ns_);
    const std::int64_t at_ns = now_ns_;
    offer([&] { return publishers_.define(sample, at_ns); });
  }
  void send(PoseSample sample) {
    plain_.move(sample, now_ns_);
    const std::int64_t at_ns = now_ns_;
    offer([&] { return publishers_.move(sample, at_ns); });
  }

  void define_or_remove(std::uint64_t id, Sender& sender) {
    DefinitionSample sample;
    sample.publisher = id;
    sample.incarnation = sender.incarnation;
    sample.sequence = ++sender.sequence;
    sample.object_number = static_cast<std::uint32_t>(make_.below(kNumbers));
    sample.removed = make_.chance(0.25);
    sample.name = name();
    sample.publisher_name = "sender";
    sample.moving = make_.chance(0.85);
    sample.lost_policy = static_cast<std::uint8_t>(make_.below(3));
    sample.filter.layers = make_.layers();
    sample.pose = pose();
    Shape shape;
    shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0.5});
    sample.shape = shape;
    sender.definitions.push_back(sample);
    if (make_.chance(0.05)) return;  // lost; or comes when a newer one has come
    sender.last_definition = sample.sequence;
    send(sample);
  }
  void pose_some(std::uint64_t id, Sender& sender) {
    PoseSample sample;
    sample.publisher = id;
    sample.incarnation = sender.incarnation;
    sample.sequence = ++sender.sequence;
    sample.definitions_through =
        make_.chance(0.2) ? sample.sequence + static_cast<std::uint64_t>(make_.below(12)) : sender.last_definition;
    sample.flags = make_.chance(0.02) ? wire_contract::kPosesAllSaid : 0;
    sample.received_ns = now_ns_;
    const bool with_velocities = make_.chance(0.5);
    for (std::uint32_t number = 0; number < kNumbers; ++number) {
      if (make_.chance(0.5)) continue;
      for (int times = make_.chance(0.05) ? 2 : 1; times > 0; --times) {
        sample.object_numbers.push_back(number);
        const std::array<double, 7> at = pose();
        sample.poses.insert(sample.poses.end(), at.begin(), at.end());
        for (int k = 0; with_velocities && k < 6; ++k) sample.velocities.push_back(make_.uniform(-1, 1));
      }
    }
    if (make_.chance(0.02)) sample.poses.push_back(0);
    sender.poses.push_back(sample);
    if (!make_.chance(0.05)) send(sample);
  }
  void once_more(Sender& sender) {
    if (make_.chance(0.5) && !sender.definitions.empty()) return send(make_.one_of(sender.definitions));
    if (!sender.poses.empty()) send(make_.one_of(sender.poses));
  }
  void live_or_die(std::uint64_t id, Sender& sender) {
    const double what = make_.uniform(0, 1);
    if (what < 0.2) {
      ++sender.incarnation;
      sender.sequence = sender.last_definition = 0;
      return;
    }
    const WriterKind kind = make_.chance(0.5) ? WriterKind::object : WriterKind::pose;
    if (what < 0.75) {
      plain_.writer_lost(id, kind, now_ns_);
      const std::int64_t at_ns = now_ns_;
      offer([&] { return publishers_.writer_lost(id, kind, at_ns); });
    } else {
      plain_.writer_alive(id, kind);
      publishers_.writer_alive(id, kind, now_ns_);
    }
  }
  void somebody_else() {
    const std::string name = this->name();
    const std::optional<ObjectId> id = world_.find(name);
    step();
    if (id) {
      world_.remove(*id, EndReason::removed);
      return plain_.remove_by_name(name);
    }
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives.emplace_back(Sphere{Vec3::Zero(), 0.5});
    world_.define(definition);
    plain_.add_other(name);
  }
  void operate() {
    now_ns_ += make_.chance(0.001) ? 70'000'000'000 : make_.below(20'000'000);
    const std::uint64_t id = 1 + static_cast<std::uint64_t>(make_.below(kPublishers));
    Sender& sender = senders_[id];
    const double what = make_.uniform(0, 1);
    if (what < 0.25) define_or_remove(id, sender);
    else if (what < 0.65) pose_some(id, sender);
    else if (what < 0.75) once_more(sender);
    else if (what < 0.85) live_or_die(id, sender);
    else if (what < 0.88) somebody_else();
    else if (what < 0.95) step(), plain_.settle(now_ns_), publishers_.settle(now_ns_);
    else step();
  }

  void expect_owner(const std::string& name) {
    const auto owner = plain_.owner(name);
    const std::optional<ObjectId> id = world_.find(name);
    ASSERT_EQ(id.has_value(), owner.has_value()) << name;
    if (!id) return;
    const ObjectInfo& info = *world_.info(*id);
    EXPECT_EQ(info.publisher, owner->first) << name;
    if (owner->first == 0) return;
    const PlainPublishers::Object& object = plain_.object(*owner);
    EXPECT_EQ(info.moving, object.moving) << name;
    EXPECT_EQ(info.filter.layers, object.layers) << name;
    EXPECT_EQ(info.lost_policy, object.policy) << name;
    EXPECT_EQ(publishers_.velocity(*id), object.velocity) << name;
    step();
    const SnapshotRing::Lease now = world_.newest();
    const Pose& pose = now->poses[slot_of(*id)];
    EXPECT_EQ(pose.position, Vec3(object.pose[0], object.pose[1], object.pose[2])) << name;
    EXPECT_EQ(now->stale[slot_of(*id)] != 0, object.is_stale) << name;
  }
  void expect_same() {
    for (const char* name : {"ape", "bat", "cat", "cow", "dog"}) {
      if (make_.chance(0.3)) expect_owner(name);
      const std::vector<std::uint64_t> waiting = publishers_.waiting_for(name);
      EXPECT_EQ(std::set<std::uint64_t>(waiting.begin(), waiting.end()), plain_.waiting_for(name)) << name;
    }
    EXPECT_EQ(publishers_.size(), plain_.size());
    for (std::uint64_t id = 1; id <= kPublishers; ++id) {
      const PlainPublishers::Party* party = plain_.party(id);
      EXPECT_EQ(publishers_.is_live(id), party != nullptr && !party->lost);
      EXPECT_EQ(publishers_.is_complete(id), party != nullptr && !party->lost && party->said_all);
      EXPECT_EQ(publishers_.applied_through(id), party != nullptr ? party->through : 0);
    }
    expect_counts(publishers_.counts(), plain_.counts);
    EXPECT_EQ(publishers_.take_changes(), std::exchange(plain_.changes, 0));
    publishers_.take_notices();
  }
  static void expect_counts(const service::PublisherCounts& a, const service::PublisherCounts& b) {
    EXPECT_EQ(a.definitions_applied, b.definitions_applied);
    EXPECT_EQ(a.definitions_late, b.definitions_late);
    EXPECT_EQ(a.definitions_refused, b.definitions_refused);
    EXPECT_EQ(a.name_conflicts, b.name_conflicts);
    EXPECT_EQ(a.batches_applied, b.batches_applied);
    EXPECT_EQ(a.batches_parked, b.batches_parked);
    EXPECT_EQ(a.batches_dropped, b.batches_dropped);
    EXPECT_EQ(a.batches_malformed, b.batches_malformed);
    EXPECT_EQ(a.poses_applied, b.poses_applied);
    EXPECT_EQ(a.poses_late, b.poses_late);
    EXPECT_EQ(a.poses_unknown, b.poses_unknown);
    EXPECT_EQ(a.poses_refused, b.poses_refused);
  }

  std::mt19937_64 random_{0};
  RandomWorld make_{random_};
  service::PublisherLimits limits_{.parked_batches = 3, .forget_after_ns = 100'000'000};
  World world_{WorldOptions{}};
  Publishers publishers_{world_, limits_};
  PlainPublishers plain_{limits_};
  std::map<std::uint64_t, Sender> senders_;
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST_F(PublishersTwin, WhateverComesTwiceLateOrFromAnEarlierLifeTheWorldHoldsWhatWasSaidLast) {
  random_ = oracle::seeded(173);
  for (int i = 0; i < operations_asked() && !HasFailure(); ++i) {
    SCOPED_TRACE("operation " + std::to_string(i));
    operate();
    expect_same();
  }
  EXPECT_GT(plain_.counts.poses_applied, 100u);
  EXPECT_GT(plain_.counts.poses_late, 10u);
  EXPECT_GT(plain_.counts.name_conflicts, 10u);
  EXPECT_GT(plain_.counts.batches_dropped, 0u);
}

}  // namespace
}  // namespace collided::model
