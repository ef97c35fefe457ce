#include <malloc.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>

#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/growth/engine_laws.hpp"

namespace collided::growth {
using namespace engine;
namespace {

constexpr std::int64_t kPeriodNs = 10'000'000;  // 100 Hz
constexpr std::size_t kFew = 100;
constexpr int kSteps = 5;
constexpr int kWarming = 40;
constexpr double kApart_m3 = 10;      // for each mover: one in twenty touches another
constexpr double kCrowded_m3 = 1.05;  // for each body: four contacts of its own, two bodies share each
constexpr double kContactsOfBody = 2;

double held_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// Balls of one radius at random places of a cube that grows with their number.
class BallCrowd {
 public:
  BallCrowd(std::size_t count, double volume_m3, std::uint64_t seed)
      : random_(seed), side_m_(std::cbrt(volume_m3 * static_cast<double>(count))) {
    const double before = held_bytes();
    world_ = std::make_unique<World>(WorldOptions{.max_objects = static_cast<std::uint32_t>(count + 10)});
    for (std::size_t i = 0; i < count; ++i) {
      ObjectDefinition definition{.name = std::to_string(i), .scene = "", .shape = {}, .pose = {}, .filter = {}};
      definition.shape.primitives = {Sphere{Vec3::Zero(), kRadius_m}};
      definition.pose.position = place();
      definition.publisher = 1;
      ids_.push_back(std::get<ObjectId>(world_->define(definition)));
      poses_.push_back(definition.pose);
    }
    moved_ = std::make_unique<bool[]>(count);
    step_world();
    move(count);  // one step so that both states are there
    bytes_ = held_bytes() - before - static_cast<double>(count * (sizeof(ObjectId) + sizeof(Pose) + sizeof(bool)));
  }
  /// The first of them move by at most two centimetres and all is decided; returns milliseconds.
  double move(std::size_t count) {
    std::uniform_real_distribution<double> shift(-0.02, 0.02);
    for (std::size_t i = 0; i < count; ++i) poses_[i].position += Vec3(shift(random_), shift(random_), shift(random_));
    time_ns_ += kPeriodNs;
    const double started = bench::thread_seconds();
    if (count > 0) {
      world_->move(std::span(ids_).first(count), std::span(poses_).first(count), time_ns_, false,
                   std::span(moved_.get(), count));
      world_->advance(1, time_ns_);
    }
    step_world();
    return 1e3 * (bench::thread_seconds() - started);
  }
  std::vector<double> moves(std::size_t count) {
    std::vector<double> ms;
    // The first steps after another number moved still end what that one began, and bring back into the caches what it
    // drove out.
    for (int i = 0; i < (count > kFew ? 1 : kWarming); ++i) move(count);
    for (int i = 0; i < kSteps; ++i) ms.push_back(move(count));
    return ms;
  }
  /// Pairs looked at by the last step: candidates and exact tests.
  double looks() const { return world_->cost().candidate_pairs + world_->cost().exact_tests; }
  /// Of a ray through the crowd to its nearest hit: nanoseconds, and what it visits.
  struct Rays {
    std::vector<double> ns;
    double visits = 0;
  };
  Rays rays(std::size_t count) {
    std::uniform_real_distribution<double> turn(-1, 1);
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 from = place();
      numbers.insert(numbers.end(),
                     {from[0], from[1], from[2], turn(random_), turn(random_), turn(random_), 2 * side_m_});
    }
    Answers answers;
    QueryScratch scratch;
    const SnapshotRing::Lease state = world_->newest();
    Rays made;
    for (int i = 0; i < kSteps; ++i) {
      const double started = bench::thread_seconds();
      answer(*state, {.numbers = numbers}, answers, scratch);
      made.ns.push_back(1e9 * (bench::thread_seconds() - started) / static_cast<double>(count));
    }
    for (std::size_t i = 0; i < count; ++i) made.visits += answers.nodes[i] + answers.exact_tests[i];
    made.visits /= static_cast<double>(count);
    return made;
  }
  double bytes() const { return bytes_; }
  double contacts() const { return static_cast<double>(world_->contacts().size()); }

 private:
  static constexpr double kRadius_m = 0.5;

  Vec3 place() {
    std::uniform_real_distribution<double> along(0, side_m_);
    const double x = along(random_), y = along(random_);
    return {x, y, along(random_)};
  }
  void step_world() {
    if (!world_->step(time_ns_, 1, {})) std::abort();
  }

  std::mt19937_64 random_;
  double side_m_;
  std::unique_ptr<World> world_;
  std::vector<ObjectId> ids_;
  std::vector<Pose> poses_;
  std::unique_ptr<bool[]> moved_;
  double bytes_ = 0;
  std::int64_t time_ns_ = 1'000'000'000'000;
};

}  // namespace

std::vector<Law> mover_laws(const GrowthSetting& setting) {
  std::vector<Law> laws{{.knob = "movers",
                         .what = "step, all move",
                         .unit = "ms",
                         .theory = {1},
                         .reason = "the pairs it looks at grow as theory says (next row); what it knows of more than "
                                   "some 10,000 movers is larger "
                                   "than the caches"},
                        {.knob = "movers", .what = "step, all move: pairs looked at", .unit = "pairs", .theory = {1}},
                        {.knob = "movers", .what = "step, 100 of them move", .unit = "ms", .theory = {0}},
                        {.knob = "movers", .what = "step, none moves", .unit = "ms", .theory = {0}},
                        {.knob = "movers", .what = "memory, two states and all", .unit = "bytes", .theory = {1}},
                        {.knob = "movers",
                         .what = "ray, nearest hit, one density",
                         .unit = "ns",
                         .theory = {0},
                         .reason = "what it visits levels off as theory says (next row); cells and movers of a larger "
                                   "crowd are larger than the caches"},
                        {.knob = "movers",
                         .what = "ray, nearest hit: visits",
                         .unit = "cells, movers",
                         .theory = {0},
                         .reason = "in a crowd some mean free paths wide many rays leave it before they hit"}};
  for (const double size : half_decades(100, setting.quick ? 10'000 : 1e6)) {
    BallCrowd crowd(static_cast<std::size_t>(size), kApart_m3, setting.seed);
    laws[0].samples.push_back(sample_of(size, crowd.moves(static_cast<std::size_t>(size))));
    laws[1].samples.push_back(sample_of(size, {crowd.looks()}));
    laws[2].samples.push_back(sample_of(size, crowd.moves(kFew)));
    laws[3].samples.push_back(sample_of(size, crowd.moves(0)));
    laws[4].samples.push_back(sample_of(size, {crowd.bytes()}));
    const BallCrowd::Rays rays = crowd.rays(setting.quick ? 500 : 5'000);
    laws[5].samples.push_back(sample_of(size, rays.ns));
    laws[6].samples.push_back(sample_of(size, {rays.visits}));
    std::printf("%.0f movers\n", size);
    std::fflush(stdout);
  }
  return laws;
}

std::vector<Law> contact_laws(const GrowthSetting& setting) {
  std::vector<Law> laws{
      {.knob = "contacts",
       .what = "step, all that hold move on",
       .unit = "ms",
       .theory = {1},
       .reason = "the pairs it looks at grow as theory says (next row); contacts and bodies of more than some 10,000 "
                 "are larger "
                 "than the caches"},
      {.knob = "contacts", .what = "step, all move: pairs looked at", .unit = "pairs", .theory = {1}},
      {.knob = "contacts",
       .what = "step, 100 bodies move",
       .unit = "ms",
       .theory = {0},
       .reason = "the pairs it looks at grow as theory says (next row); they come from more distant memory"},
      {.knob = "contacts", .what = "step, 100 move: pairs looked at", .unit = "pairs", .theory = {0}},
      {.knob = "contacts", .what = "step, none moves", .unit = "ms", .theory = {0}}};
  for (const double size : half_decades(100, setting.quick ? 10'000 : 1e6)) {
    const auto bodies = static_cast<std::size_t>(size / kContactsOfBody);
    BallCrowd crowd(bodies, kCrowded_m3, setting.seed);
    const double contacts = crowd.contacts();
    laws[0].samples.push_back(sample_of(contacts, crowd.moves(bodies)));
    laws[1].samples.push_back(sample_of(contacts, {crowd.looks()}));
    laws[2].samples.push_back(sample_of(contacts, crowd.moves(std::min(kFew, bodies))));
    laws[3].samples.push_back(sample_of(contacts, {crowd.looks()}));
    laws[4].samples.push_back(sample_of(contacts, crowd.moves(0)));
    std::printf("%.0f contacts of %zu bodies\n", contacts, bodies);
    std::fflush(stdout);
  }
  return laws;
}

}  // namespace collided::growth
