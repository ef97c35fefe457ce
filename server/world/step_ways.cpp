#include <algorithm>

#include "server/world/step.hpp"

namespace collided {
namespace {

/// An object that goes farther in a step than this share of its least width may leave behind what it passed through:
/// two that pass through each other go at least their two widths.
constexpr double kUnsweptShare = 0.5;

/// Looks at parts that the sweep of one pair may take: some 20 ms, that the others wait for.
constexpr std::uint32_t kSweepLooks = 10'000;

}  // namespace

/// The way of a lone sphere between its last two poses; nothing for other objects, new ones and teleported ones.
std::optional<MovingSphere> Step::way_of(std::uint32_t slot) const {
  const std::optional<Sphere>& sphere = s.lone_spheres[slot];
  if (!sphere || s.motion[slot] != Motion::moved) return std::nullopt;
  return MovingSphere{.start = place(s.frames_before[slot], sphere->center),
                      .end = place(s.frames[slot], sphere->center),
                      .radius_m = sphere->radius_m};
}

bool Step::is_fast(std::uint32_t slot) const {
  // A lone sphere is swept by itself at any speed.
  if (s.motion[slot] != Motion::moved || s.lone_spheres[slot]) return false;
  const MoverSize& size = s.sizes[slot];
  return longest_way_m(s.frames_before[slot], s.frames[slot], size.reach_m) > kUnsweptShare * size.least_width_m;
}

/// The way of any object in this step; a lone sphere's is that of its centre.
BodyWay Step::body_way(std::uint32_t slot) const {
  const Frame& before = s.motion[slot] == Motion::moved ? s.frames_before[slot] : s.frames[slot];
  if (!s.lone_spheres[slot]) return {before, s.frames[slot]};
  BodyWay way{s.frames[slot], s.frames[slot]};
  const Vec3& center = s.lone_spheres[slot]->center;
  way.from.position = place(before, center) - (place(s.frames[slot], center) - s.frames[slot].position);
  way.travel = way.to.position - way.from.position;
  return way;
}

SweepOptions Step::sweep_options(std::uint32_t mover) const {
  const double way_s = static_cast<double>(s.posed_ns[mover] - s.posed_before_ns[mover]) * 1e-9;
  return {.width = std::clamp(s.options.sweep_width_s / way_s, 1e-12, 1e-3),
          .contacts = wishes.contacts,
          .most_looks = kSweepLooks};
}

void Step::set_ball(std::uint32_t slot, const std::optional<MovingSphere>& way) {
  const std::optional<Sphere>& sphere = s.lone_spheres[slot];
  BallWay& ball = s.balls[slot];
  ball.radius_m = sphere ? sphere->radius_m : -1;
  if (!sphere) return;
  ball.end = way ? way->end : place(s.frames[slot], sphere->center);
  if (!way) return;
  ball.start = way->start;
  ball.displacement = s.frames[slot].position - s.frames_before[slot].position;
}

/// A lone sphere is swept whatever its speed, exactly, past anything that does not turn fast; other pairs where one of
/// the two is fast.
std::optional<SweptTouch> Step::sweep_between(std::uint32_t first, std::uint32_t second, std::uint32_t& mover) {
  if (s.motion[first] == Motion::placed || s.motion[second] == Motion::placed) return std::nullopt;
  const auto turns_fast = [&](std::uint32_t slot) {
    return s.fast[slot] != 0 && !s.lone_spheres[slot] && s.frames_before[slot].rotation != s.frames[slot].rotation;
  };
  if (!turns_fast(first) && !turns_fast(second)) {
    if (std::optional<SweptTouch> found = sweep_sphere(first, second)) return found;
    mover = second;
    if (const std::optional<SweptTouch> found = sweep_sphere(second, first)) return turned_round(*found);
  }
  mover = s.fast[first] != 0 ? first : second;
  if (s.fast[mover] == 0) return std::nullopt;
  return sweep_bodies(first, second);
}

SweptTouch Step::sweep_bodies(std::uint32_t first, std::uint32_t second) {
  SweptTouch touch;
  const SweptBody a(*(*s.objects)[first], body_way(first));
  const SweptBody b(*(*s.objects)[second], body_way(second));
  sweep(a, b, sweep_options(s.fast[first] != 0 ? first : second), walk, touch);
  return touch;
}

/// The mover's way as seen from the other object, which keeps its last orientation: its displacement is taken off.
std::optional<SweptTouch> Step::sweep_sphere(std::uint32_t mover, std::uint32_t other) {
  const std::optional<Sphere>& sphere = s.lone_spheres[mover];
  if (!sphere) return std::nullopt;
  const bool other_moved = s.motion[other] == Motion::moved;
  const Frame& before = s.motion[mover] == Motion::moved ? s.frames_before[mover] : s.frames[mover];
  SphereSweep sweep{.mover = {.start = place(before, sphere->center),
                        .end = place(s.frames[mover], sphere->center),
                        .radius_m = sphere->radius_m},
              .width = s.options.sweep_width};
  if (other_moved) sweep.mover.start += s.frames[other].position - s.frames_before[other].position;
  sweep_object(sweep, placed(other), walk);
  return sweep.found;
}

}  // namespace collided
