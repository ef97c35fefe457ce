// What a ray against a polynomial surface costs, beside what it tells: a sphere and a torus at three widths of the bracket,
// the sphere of closed form for comparison, and what rationals alone take. Processor time of this thread.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/readers/polynomial_text.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/studies/bench/clock.hpp"

namespace collided::bench {
using namespace engine;
namespace {

std::vector<Ray> rays_at(double reach, std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  const auto point = [&](double size) { return Vec3(size * any(random), size * any(random), size * any(random)); };
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Vec3 origin = point(10 * reach);
    if (origin.norm() > 2 * reach) rays.push_back({origin, point(reach) - origin});
  }
  return rays;
}

/// Nanoseconds a ray, how many are hit, and the worst bound told of a distance and of a normal.
template <class Cast>
void time_rays(const char* name, const std::vector<Ray>& rays, const Cast& cast) {
  std::vector<double> ns;
  std::size_t hits = 0, by_double = 0;
  double worst_m = 0;
  for (int run = 0; run < 5; ++run) {
    hits = by_double = 0;
    const double begin = thread_seconds();
    for (const Ray& ray : rays) {
      double error_m = 0;
      const ExactResult verdict = cast(ray, error_m);
      hits += verdict.yes();
      by_double += verdict.level == Level::filter;
      worst_m = std::max(worst_m, error_m);
    }
    ns.push_back(1e9 * (thread_seconds() - begin) / static_cast<double>(rays.size()));
  }
  std::sort(ns.begin(), ns.end());
  std::printf("  %-34s %9.0f ns a ray (%.0f to %.0f), %zu of %zu hit, %zu by double alone, distances within %.2g m\n",
              name, ns[2], ns.front(), ns.back(), hits, rays.size(), by_double, worst_m);
}

void time_surface(const char* name, const char* text, const std::vector<Ray>& rays) {
  const ImplicitSurface surface = read_implicit_surface(text);
  std::printf("%s: %s\n", name, text);
  const auto cast = [&](double relative_width) {
    return [&surface, relative_width](const Ray& ray, double& error_m) {
      ImplicitHit hit;
      const ExactResult verdict = cast_ray(ray, surface, hit, relative_width);
      if (verdict.yes()) error_m = hit.distance_error_m;
      return verdict;
    };
  };
  time_rays("as sharp as asked by default", rays, cast(kBracketAsked));
  time_rays("bracket within 2^-44", rays, cast(0x1p-44));
  {
    const PrecisionScope within({.highest = Level::rational, .error_asked_m = 1e-6});
    time_rays("within 1 um", rays, cast(kBracketAsked));
  }
  const std::vector<Ray> few(rays.begin(),
                             rays.begin() + std::min<std::ptrdiff_t>(2000, static_cast<std::ptrdiff_t>(rays.size())));
  time_rays("rationals alone", few, [&](const Ray& ray, double& error_m) {
    ImplicitHit hit;
    const ExactResult verdict = cast_ray_by_rationals(ray, surface, hit);
    if (verdict.yes()) error_m = hit.distance_error_m;
    return verdict;
  });
}

}  // namespace
}  // namespace collided::bench

int main() {
  using namespace collided;
  using namespace collided::bench;
  std::mt19937_64 random = oracle::seeded(20);
  const std::vector<Ray> at_sphere = rays_at(1, 20'000, random);
  std::printf("sphere of closed form\n");
  time_rays("whole ladder", at_sphere, [](const Ray& ray, double& error_m) {
    RayHit hit;
    const ExactResult verdict = cast_ray(ray, Sphere{Vec3::Zero(), 1}, hit);
    if (verdict.yes()) error_m = hit.distance_error_m;
    return verdict;
  });
  time_surface("sphere", "x^2+y^2+z^2-1", at_sphere);
  time_surface("torus", "(x^2+y^2+z^2+3)^2 - 16*(x^2+y^2)", rays_at(3, 20'000, random));
  return 0;
}
