// Bounds of objects at their poses are not kept: a step takes those of what rests from the bounds of motions.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/world/step/step_motion.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kPeriod_ns = 10'000'000;
constexpr int kObjects = 60;

class PoseBounds : public testing::Test {
 protected:
  Pose any_pose() {
    std::uniform_real_distribution<double> part(-1, 1);
    const double x = part(random_), y = part(random_), z = part(random_), w = part(random_);
    return {.position = {1e3 * x, y, z}, .rotation = Quat(2 + w, x, y, z).normalized()};
  }
  SharedPrimitives any_shape() {
    const Sphere ball{Vec3::Zero(), 0.3};
    const Box box{.center = {0.1, 0, 0}, .half_m = {1, 2, 0.5}};
    switch (random_() % 4) {
      case 0: return {ball};
      case 1: return {Sphere{{0.2, 0, 0.1}, 0.4}};
      case 2: return {box};
      default: return {ball, box};
    }
  }
  void define() {
    auto info = std::make_shared<ObjectInfo>();
    info->id = rows_.take_slot();
    info->name = std::to_string(info->id);
    info->publisher = 1 + random_() % 2;
    info->moving = true;
    info->primitives = any_shape();
    ids_.push_back(info->id);
    const std::uint32_t source = sources_.add_object(info->publisher);
    rows_.put(std::move(info), any_pose(), source, kPosedAtStep);
  }
  void remove(std::size_t number) {
    sources_.remove_object(rows_.source(slot_of(ids_[number])));
    rows_.remove(ids_[number]);
    ids_[number] = ids_.back();
    ids_.pop_back();
  }
  void move(ObjectId id, bool is_placed) {
    const std::uint32_t source = rows_.source(slot_of(id));
    const Source& of = sources_[source];
    const std::int64_t time_ns = of.admitted(now_ns_);
    const std::int64_t since_ns = of.is_timed ? of.rested_until(time_ns) : 0;
    sources_.note_posed(source, is_placed || rows_.is_new(slot_of(id)));
    ASSERT_TRUE(rows_.move(id, any_pose(), {.time_ns = time_ns, .since_ns = since_ns},
                           is_placed ? Motion::placed : Motion::moved));
  }
  void change_any() {
    for (const ObjectId id : std::vector(ids_)) {
      if (random_() % 4 == 0) move(id, random_() % 5 == 0);
    }
    if (random_() % 3 == 0) remove(random_() % ids_.size());
    if (random_() % 3 == 0) define();
  }
  /// As World::step() does it, with the comparison where pairs are decided.
  void step() {
    sources_.begin_step(now_ns_, motion_.is_any_open());
    rows_.stamp_changes(now_ns_, sources_);
    motion_.begin_step(sources_, apart_);
    compare();
    apart_.end_step();
    sources_.end_step();
    motion_.end_step(sources_.floor_ns());
    rows_.end_step();
  }
  void compare() {
    for (const ObjectId id : ids_) {
      const std::uint32_t slot = slot_of(id);
      const Aabb known = motion_.pose_bounds(slot);
      const Aabb anew = rows_.bounds(slot);
      ASSERT_EQ(known.low, anew.low) << "slot " << slot;
      ASSERT_EQ(known.high, anew.high) << "slot " << slot;
      const Aabb& of_motion = motion_.bounds()[slot];
      ASSERT_TRUE((of_motion.low.array() <= known.low.array()).all() &&
                  (of_motion.high.array() >= known.high.array()).all());
      const bool is_wider = of_motion.low != known.low || of_motion.high != known.high;
      ++(!is_wider ? same_ : rows_.has_moved(slot) ? wider_in_motion_ : wider_at_rest_);
    }
  }

  std::mt19937_64 random_ = oracle::seeded(20261128);
  ObjectRows rows_;
  Sources sources_;
  StepMotion motion_{rows_};
  SeparationCache apart_;
  std::vector<ObjectId> ids_;
  std::int64_t now_ns_ = 1'000'000'000'000;
  int same_ = 0;
  int wider_in_motion_ = 0;
  int wider_at_rest_ = 0;  // what moved before waits for another publisher's time
};

// Two publishers of which one is often silent, so that some of what rests is still decided on a motion of its past.
TEST_F(PoseBounds, AreThoseWorkedOutAnewWhateverMovesRestsOrWaits) {
  for (int i = 0; i < kObjects; ++i) define();
  for (int i = 0; i < 300; ++i) {
    now_ns_ += kPeriod_ns;
    ASSERT_NO_FATAL_FAILURE(change_any());
    sources_.advance(1, now_ns_);
    if (i % 4 == 0) sources_.advance(2, now_ns_ - kPeriod_ns / 2);
    ASSERT_NO_FATAL_FAILURE(step());
  }
  EXPECT_GT(same_, 1'000);
  EXPECT_GT(wider_in_motion_, 1'000);
  EXPECT_GT(wider_at_rest_, 1'000);
}

}  // namespace
}  // namespace collided::engine
