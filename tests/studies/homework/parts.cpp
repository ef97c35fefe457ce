#include <algorithm>
#include <cmath>

#include "client/cli/publish/response/spheres.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/homework/homework_page.hpp"

namespace collided::homework {
using namespace engine;
namespace {

double median_us(std::vector<double>& seconds) {
  std::sort(seconds.begin(), seconds.end());
  return 1e6 * seconds[seconds.size() / 2];
}

double median_frame_us(const Recording& recording, bool contacts, double& mean_contacts) {
  CollidedWorld world(recording, contacts);
  std::vector<double> seconds;
  mean_contacts = 0;
  for (const std::vector<Pose>& poses : recording.poses) {
    const double start = bench::thread_seconds();
    world.frame(poses);
    seconds.push_back(bench::thread_seconds() - start);
    mean_contacts += static_cast<double>(world.pairs().size()) / static_cast<double>(recording.poses.size());
  }
  return median_us(seconds);
}

/// The recorded contacts are answered again: spheres that stay where they were recorded, and the flips.
double median_response_us(const Recording& recording) {
  CollidedWorld world(recording);
  std::vector<response::Sphere> spheres;
  for (std::size_t i = 0; i < recording.objects(); ++i) {
    spheres.push_back({recording.mesh(i).radius_m, recording.poses[0][i].position, Vec3(0.1, 0.2, 0.3), Vec3(1, 0, 0)});
  }
  response::Spheres motion({}, std::move(spheres));
  std::vector<double> seconds;
  for (const std::vector<Pose>& poses : recording.poses) {
    world.frame(poses);
    const double start = bench::thread_seconds();
    world.for_each_change([&](std::size_t a, std::size_t b, bool began) {
      if (began) {
        motion.contact_began(a, b);
      } else {
        motion.contact_ended(a, b);
      }
    });
    motion.step(1 / 60.0);
    seconds.push_back(bench::thread_seconds() - start);
  }
  return median_us(seconds);
}

}  // namespace

Parts measure_parts(std::uint64_t seed, bool quick) {
  Parts parts;
  const std::size_t objects = quick ? 50 : 1'000;
  parts.problem = {.objects = objects,
                   .relative_size = 0.2 * std::cbrt(50.0 / static_cast<double>(objects)),
                   .frames = quick ? std::size_t{20} : std::size_t{60},
                   .seed = seed};
  const Recording recording = record(parts.problem);
  parts.detection_us = median_frame_us(recording, false, parts.contacts);
  parts.determination_us = median_frame_us(recording, true, parts.contacts) - parts.detection_us;
  parts.response_us = median_response_us(recording);
  return parts;
}

}  // namespace collided::homework
