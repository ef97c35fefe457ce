#include "client/cli/publish/response/spheres.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace collided::response {
namespace {

constexpr std::uint64_t kStickingAnswers = 3;

void count_episode(SphereLedger& ledger, std::uint64_t answers) {
  if (answers >= kStickingAnswers) ++ledger.sticking;
  ledger.longest_flips = std::max(ledger.longest_flips, answers);
}

}  // namespace

double mass(const Sphere& sphere) { return sphere.radius_m * sphere.radius_m * sphere.radius_m; }

Spheres::Spheres(const SphereOptions& options, std::vector<Sphere> spheres)
    : options_(options),
      spheres_(std::move(spheres)),
      spring_{.stiffness_n_m = options.stiffness_n_m},
      free_s_(spheres_.size(), 0) {
  if (!(options.restitution >= 0 && options.restitution <= 1)) throw std::invalid_argument("restitution: 0 to 1");
  if (options.answer == ResponseLaw::compliant) spring_.damping_ratio = damping_of_restitution(options.restitution);
  ledger_.energy_before = energy();
  ledger_.momentum_before = momentum();
}

double Spheres::gap(const Pair& pair) const {
  const Sphere& a = spheres_[pair.first];
  const Sphere& b = spheres_[pair.second];
  return (b.position - a.position).norm() - (a.radius_m + b.radius_m);
}

RelativeMotion Spheres::between(const Pair& pair) const {
  const Sphere& a = spheres_[pair.first];
  const Sphere& b = spheres_[pair.second];
  return {b.position - a.position, b.velocity - a.velocity};
}

void Spheres::contact_began(std::size_t a, std::size_t b, const Touch& touch) {
  if (a == b) return;
  const Pair pair = std::minmax(a, b);
  const auto [found, is_new] = open_.try_emplace(pair);
  Episode& episode = found->second;
  episode.has_ended = false;
  if (!is_new) return;
  ++ledger_.contacts;
  ledger_.seen_overlap_m = std::max(ledger_.seen_overlap_m, -gap(pair));
  if (options_.answer == ResponseLaw::compliant) catch_up(pair, episode, touch);
}

void Spheres::contact_ended(std::size_t a, std::size_t b) {
  const auto found = open_.find(std::minmax(a, b));
  if (found == open_.end()) return;
  found->second.has_ended = true;
  if (found->second.depth_m == 0) close(found);
}

void Spheres::close(std::map<Pair, Episode>::iterator episode) {
  count_episode(ledger_, episode->second.answers);
  open_.erase(episode);
}

void Spheres::touched_cube(std::size_t sphere, const Vec3& normal) {
  ++ledger_.cube_contacts;
  if (options_.answer == ResponseLaw::compliant) return;
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  // Only a sphere that still moves outward is reflected: its step may have reflected it already.
  Sphere& touching = spheres_[sphere];
  if (touching.position[axis] * touching.velocity[axis] > 0) touching.velocity[axis] *= -options_.restitution;
}

bool Spheres::answer(const Pair& pair, Episode& episode, double seconds) {
  Sphere& a = spheres_[pair.first];
  Sphere& b = spheres_[pair.second];
  switch (options_.answer) {
    case ResponseLaw::flip:
      if (!options_.every_frame && episode.answers > 0) return false;
      flip(a.velocity, b.velocity);
      return true;
    case ResponseLaw::impulse: {
      const Vec3 along = b.position - a.position;
      // Centres at one point have no line between them. The x axis is taken, so that all runs agree.
      const Vec3 normal = along.norm() > 0 ? Vec3(along.normalized()) : Vec3(Vec3::UnitX());
      return restitute(a.velocity, b.velocity, {1 / mass(a), 1 / mass(b)}, normal, options_.restitution);
    }
    case ResponseLaw::compliant: break;
  }
  const double distance = between(pair).place_m.norm();
  // A spring that has released begins again at its length, or at the current distance if that is smaller.
  const double length_m = episode.depth_m > 0 ? distance + episode.depth_m : std::min(distance, episode.touch_m);
  return push(pair, episode, length_m, 0, seconds);
}

/// Computes a contact that began in the past, up to now. The two moved straight and had the reported depth at `seen_s`,
/// so they touched when their distance was larger by that depth, unless the bracket of the instant excludes it.
void Spheres::catch_up(const Pair& pair, Episode& episode, const Touch& touch) {
  const RelativeMotion now = between(pair);
  const double flown_s = std::min(free_s_[pair.first], free_s_[pair.second]);
  const double speed2 = now.velocity_m_s.squaredNorm();
  double ago_s = touch.seen_s;
  if (speed2 > 0) {
    const Vec3 seen = now.place_m - touch.seen_s * now.velocity_m_s;
    const double along = seen.dot(now.velocity_m_s);
    const double farther2 = touch.depth_m * (touch.depth_m + 2 * seen.norm());
    if (farther2 > 0) ago_s = touch.seen_s + farther2 / (std::sqrt(along * along + speed2 * farther2) - along);
  }
  ago_s = std::clamp(ago_s, touch.latest_s, std::max(touch.latest_s, touch.earliest_s));
  ago_s = std::clamp(ago_s, 0.0, flown_s);
  episode.touch_m = (now.place_m - ago_s * now.velocity_m_s).norm();
  if (push(pair, episode, episode.touch_m, ago_s, 0)) {
    ++episode.answers;
    ++ledger_.flips;
  }
}

/// Moves a pair on its spring from `back_s` ago to `seconds` from now. The velocities get the whole impulse at once;
/// the positions are corrected for the time at which it really acted.
bool Spheres::push(const Pair& pair, Episode& episode, double length_m, double back_s, double seconds) {
  Sphere& a = spheres_[pair.first];
  Sphere& b = spheres_[pair.second];
  const InverseMasses masses{1 / mass(a), 1 / mass(b)};
  const RelativeMotion now = between(pair);
  RelativeMotion motion{now.place_m - back_s * now.velocity_m_s, now.velocity_m_s};
  const SpringRun run = move_on_spring(spring_, 1 / masses.sum(), length_m, motion, back_s + seconds);
  if (!run.pushed) return false;
  const Vec3 change = motion.velocity_m_s - now.velocity_m_s;
  const Vec3 moved = motion.place_m - now.place_m - seconds * motion.velocity_m_s;
  a.velocity -= masses.a / masses.sum() * change;
  b.velocity += masses.b / masses.sum() * change;
  shift(a, -masses.a / masses.sum() * moved);
  shift(b, masses.b / masses.sum() * moved);
  episode.depth_m = run.depth_m;
  ledger_.penetration_m = std::max(ledger_.penetration_m, run.deepest_m);
  // move() adds the step.
  free_s_[pair.first] = free_s_[pair.second] = run.free_s - seconds;
  // A contact on a spring counts as one response, however many steps it takes.
  return episode.answers == 0;
}

/// Moves a sphere, but not into a wall, whose spring would then have energy for which no work was done.
void Spheres::shift(Sphere& sphere, const Vec3& by) const {
  const double most = options_.half_side_m - sphere.radius_m;
  for (int axis = 0; axis < 3; ++axis) {
    double& at = sphere.position[axis];
    if (std::abs(at) < most) at = std::clamp(at + by[axis], -most, most);
  }
}

void Spheres::move(std::size_t index, double seconds) {
  Sphere& sphere = spheres_[index];
  const double most = options_.half_side_m - sphere.radius_m;
  std::size_t components = 0;
  free_s_[index] += seconds;
  for (int axis = 0; axis < 3; ++axis) {
    bool turned = false;
    if (options_.answer == ResponseLaw::compliant) {
      const SpringRun run =
          move_between_springs(spring_, mass(sphere), most, sphere.position[axis], sphere.velocity[axis], seconds);
      ledger_.penetration_m = std::max(ledger_.penetration_m, run.deepest_m);
      if (run.pushed) free_s_[index] = std::min(free_s_[index], run.free_s);
      turned = run.began;
    } else {
      sphere.position[axis] += sphere.velocity[axis] * seconds;
      turned = mirror_between_walls(sphere.position[axis], sphere.velocity[axis], most, options_.restitution);
    }
    if (turned) ++components;
  }
  if (components > 0) ++ledger_.wall_hits[components];
  const double turn = sphere.spin.norm() * seconds;
  if (turn > 0)
    sphere.rotation =
        (Eigen::Quaterniond(Eigen::AngleAxisd(turn, sphere.spin.normalized())) * sphere.rotation).normalized();
}

void Spheres::step(double seconds) {
  ++ledger_.steps;
  for (auto at = open_.begin(); at != open_.end();) {
    auto& [pair, episode] = *at;
    ledger_.seen_overlap_m = std::max(ledger_.seen_overlap_m, -gap(pair));
    if (answer(pair, episode, seconds)) {
      ++episode.answers;
      ++ledger_.flips;
    }
    const auto answered = at++;
    if (answered->second.has_ended && answered->second.depth_m == 0) close(answered);
  }
  if (options_.answer != ResponseLaw::compliant) ledger_.penetration_m = ledger_.seen_overlap_m;
  for (std::size_t index = 0; index < spheres_.size(); ++index) move(index, seconds);
}

double Spheres::energy() const {
  double sum = 0;
  for (const Sphere& sphere : spheres_) sum += 0.5 * mass(sphere) * sphere.velocity.squaredNorm();
  if (options_.answer != ResponseLaw::compliant) return sum;
  const auto stored = [this](double depth_m) {
    return 0.5 * spring_.stiffness_n_m * std::max(depth_m, 0.0) * std::max(depth_m, 0.0);
  };
  for (const auto& [pair, episode] : open_) sum += stored(episode.depth_m);
  for (const Sphere& sphere : spheres_) {
    for (int axis = 0; axis < 3; ++axis)
      sum += stored(std::abs(sphere.position[axis]) + sphere.radius_m - options_.half_side_m);
  }
  return sum;
}

Vec3 Spheres::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (const Sphere& sphere : spheres_) sum += mass(sphere) * sphere.velocity;
  return sum;
}

SphereLedger Spheres::ledger() const {
  SphereLedger result = ledger_;
  // Episodes that have not ended count too.
  for (const auto& [pair, episode] : open_) count_episode(result, episode.answers);
  result.energy_after = energy();
  result.momentum_after = momentum();
  return result;
}

}  // namespace collided::response
