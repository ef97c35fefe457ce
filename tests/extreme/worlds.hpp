#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/brute_force.hpp"

namespace collided::extreme {
using namespace engine;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::int64_t kSecond = 1'000'000'000;

inline Pose at(const Vec3& position, const Quat& rotation = Quat::Identity()) {
  return {.position = position, .rotation = rotation};
}

inline std::shared_ptr<const TriangleMesh> shared_mesh(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

inline Shape ball_shape(double radius_m) { return {.primitives = {Sphere{Vec3::Zero(), radius_m}}, .mesh = nullptr}; }
inline Shape box_shape(const Vec3& half_m) {
  return {.primitives = {Box{.center = Vec3::Zero(), .half_m = half_m}}, .mesh = nullptr};
}
inline Shape mesh_shape(TriangleMesh mesh) { return {.primitives = {}, .mesh = shared_mesh(std::move(mesh))}; }

/// A world with short words for filling, moving and asking it. Objects move unless said otherwise; each step takes a
/// second.
class Stage {
 public:
  World world{WorldOptions{}};

  ObjectId add(const std::string& name, const Shape& shape, const Pose& pose, bool moving = true, Filter filter = {}) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape = shape;
    definition.pose = pose;
    definition.moving = moving;
    definition.filter = filter;
    const auto defined = world.define(definition);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(defined)) << std::get<Refusal>(defined).reason;
    return std::get<ObjectId>(defined);
  }
  ObjectId ball(const std::string& name, const Vec3& center, double radius_m) {
    return add(name, ball_shape(radius_m), at(center));
  }
  ObjectId block(const std::string& name, const Vec3& center, const Vec3& half_m) {
    return add(name, box_shape(half_m), at(center));
  }

  /// Static triangles, one part of the same name.
  void load(const std::string& name, TriangleMesh mesh) {
    Scene scene;
    scene.name = name;
    scene.mesh = std::move(mesh);
    scene.parts = {
        {.name = name, .first_triangle = 0, .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
  }

  void move(ObjectId id, const Pose& pose, bool teleport = false) {
    EXPECT_TRUE(world.move(id, pose, now_ns_ + kSecond, teleport));
  }
  const std::vector<Event>& step(const StepOptions& step_options = {}) {
    now_ns_ += kSecond;
    EXPECT_TRUE(world.step(now_ns_, 1, step_options));
    return world.events();
  }

  Answers ask(QuestionKind kind, const std::vector<double>& numbers, HitMode mode = HitMode::closest) const {
    Answers answers;
    QueryScratch scratch;
    Questions questions;
    questions.kind = kind;
    questions.mode = mode;
    questions.numbers = numbers;
    answer(*world.newest(), questions, answers, scratch);
    return answers;
  }
  Answers ray(const Vec3& from, const Vec3& direction, double length_m = kEndless,
              HitMode mode = HitMode::closest) const {
    return ask(QuestionKind::ray, {from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z(), length_m},
               mode);
  }

 private:
  std::int64_t now_ns_ = 0;
};

inline bool is_hit(const Answers& answers) { return answers.answers.at(0) == Verdict::hit; }
inline bool is_miss(const Answers& answers) { return answers.answers.at(0) == Verdict::miss; }

inline std::size_t count_of(const std::vector<Event>& events, EventKind kind) {
  std::size_t count = 0;
  for (const Event& event : events) count += event.kind == kind ? 1 : 0;
  return count;
}

/// Everything that an answer says, as bits; not what it cost.
inline std::vector<std::uint64_t> bits_of(const Answers& answers) {
  std::vector<std::uint64_t> bits;
  for (const auto answer : answers.answers) bits.push_back(static_cast<std::uint64_t>(answer));
  for (const std::uint32_t count : answers.hit_counts) bits.push_back(count);
  for (const AnswerHit& hit : answers.hits) {
    bits.insert(bits.end(), {hit.object, hit.triangle, hit.flags});
    for (const double x : {hit.distance_m, hit.error_m, hit.exit_m}) bits.push_back(std::bit_cast<std::uint64_t>(x));
    for (const Vec3* v : {&hit.point, &hit.normal, &hit.weights}) {
      for (int k = 0; k < 3; ++k) bits.push_back(std::bit_cast<std::uint64_t>((*v)[k]));
    }
  }
  for (const TimeBracket& bracket : answers.brackets) {
    for (const double x : {bracket.low, bracket.high}) bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  return bits;
}

/// The same bits as the twin that tests every part of every object.
inline void expect_like_brute_force(const World& world, const Questions& questions) {
  Answers fast, slow;
  QueryScratch scratch;
  const SnapshotRing::Lease lease = world.newest();
  answer(*lease, questions, fast, scratch);
  oracle::answer(*lease, questions, slow);
  ASSERT_EQ(fast.answers, slow.answers);
  ASSERT_EQ(bits_of(fast), bits_of(slow));
}

inline void expect_like_brute_force(const World& world, QuestionKind kind, const std::vector<double>& numbers,
                                    HitMode mode = HitMode::closest) {
  Questions questions;
  questions.kind = kind;
  questions.mode = mode;
  questions.numbers = numbers;
  expect_like_brute_force(world, questions);
}

/// The contacts that hold.
inline std::set<std::pair<ObjectId, ObjectId>> open_pairs(const World& world) {
  std::set<std::pair<ObjectId, ObjectId>> pairs;
  for (const OpenContact& contact : world.contacts()) pairs.emplace(contact.a, contact.b);
  return pairs;
}

/// The same by name, for worlds whose ids differ.
inline std::set<std::pair<std::string, std::string>> named_contacts(const World& world) {
  std::set<std::pair<std::string, std::string>> pairs;
  for (const auto& [a, b] : open_pairs(world)) {
    const std::string& x = world.info(a)->name;
    const std::string& y = world.info(b)->name;
    pairs.emplace(std::min(x, y), std::max(x, y));
  }
  return pairs;
}

}  // namespace collided::extreme
