// A longer ray sees all that a shorter one saw: a length that enters an interval test in rounded form loses the hit at
// its very end.
#include <gtest/gtest.h>

#include <optional>

#include "tests/extreme/mixed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::monotone_ray_test {
namespace {

std::set<std::pair<ObjectId, std::uint32_t>> met(const Answers& answers) {
  std::set<std::pair<ObjectId, std::uint32_t>> all;
  for (const AnswerHit& hit : answers.hits) all.emplace(hit.object, hit.triangle);
  return all;
}

TEST(ExtremeMonotoneRay, ALongerRayNeverLosesAHit) {
  std::mt19937_64 random = oracle::seeded(461);
  for (const extreme::Ground ground : extreme::kGrounds) {
    extreme::Mixer mixer(random, ground);
    extreme::Stage stage;
    extreme::build(stage, mixer.cast(60));
    const std::vector<double> rays = mixer.rays(150);
    for (std::size_t i = 0; i < rays.size(); i += kRayNumbers) {
      const Vec3 from(rays[i], rays[i + 1], rays[i + 2]);
      const Vec3 along(rays[i + 3], rays[i + 4], rays[i + 5]);
      // Lengths at which something is met, one step less and one more, and beyond.
      std::set<double> lengths{0, 1, 1e300, extreme::kEndless};
      for (const AnswerHit& hit : stage.ray(from, along, extreme::kEndless, HitMode::all).hits) {
        lengths.insert({std::nextafter(hit.distance_m, 0), hit.distance_m, std::nextafter(hit.distance_m, 1e300)});
      }
      std::set<std::pair<ObjectId, std::uint32_t>> before;
      std::optional<AnswerHit> nearest;
      for (const double length : lengths) {
        const auto now = met(stage.ray(from, along, length, HitMode::all));
        ASSERT_TRUE(std::includes(now.begin(), now.end(), before.begin(), before.end())) << "length " << length;
        const Answers closest = stage.ray(from, along, length);
        ASSERT_EQ(closest.hits.empty(), now.empty()) << "closest, any and all agree";
        ASSERT_EQ(stage.ray(from, along, length, HitMode::any).answers, closest.answers);
        if (!closest.hits.empty()) {
          const AnswerHit& hit = closest.hits[0];
          if (!nearest) nearest = hit;
          ASSERT_EQ(hit.object, nearest->object) << "the nearest stays the nearest";
          ASSERT_EQ(hit.triangle, nearest->triangle);
          // A length close to the hit is decided by a higher rung, whose number is sharper.
          ASSERT_LE(std::abs(hit.distance_m - nearest->distance_m), hit.error_m + nearest->error_m);
        }
        before = now;
      }
    }
  }
}

}  // namespace
}  // namespace collided::engine::monotone_ray_test
