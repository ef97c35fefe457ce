#include "client/response/spheres.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace collided::response {
namespace {

constexpr std::uint64_t kStickingAnswers = 3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
      between_{{1}, {0}},
      motion_{{0}, {0}} {
  if (!(options.restitution >= 0 && options.restitution <= 1)) throw std::invalid_argument("restitution: 0 to 1");
  if (options.answer == Answer::compliant) spring_.damping_ratio = damping_of_restitution(options.restitution);
  ledger_.energy_before = energy();
  ledger_.momentum_before = momentum();
}

double Spheres::gap(const Pair& pair) const {
  const Sphere& a = spheres_[pair.first];
  const Sphere& b = spheres_[pair.second];
  return (b.position - a.position).norm() - (a.radius_m + b.radius_m);
}

Vec3 Spheres::normal(const Pair& pair) const {
  const Vec3 along = spheres_[pair.second].position - spheres_[pair.first].position;
  const double distance = along.norm();
  // Of one place there is no line of centres: x, so that every run agrees.
  return distance > 0 ? Vec3(along / distance) : Vec3::UnitX();
}

void Spheres::contact_began(std::size_t a, std::size_t b) {
  if (a == b) return;
  const Pair pair = std::minmax(a, b);
  const bool is_new = open_.emplace(pair, Episode{}).second;
  if (is_new) ++ledger_.contacts;
}

void Spheres::contact_ended(std::size_t a, std::size_t b) {
  const auto found = open_.find(std::minmax(a, b));
  if (found == open_.end()) return;
  count_episode(ledger_, found->second.answers);
  open_.erase(found);
}

void Spheres::touched_cube(std::size_t sphere, const Vec3& normal) {
  ++ledger_.cube_contacts;
  if (options_.answer == Answer::compliant) return;
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  // The walls' own reflection may have come first: only a sphere still on its way out turns.
  Sphere& touching = spheres_[sphere];
  if (touching.position[axis] * touching.velocity[axis] > 0) touching.velocity[axis] *= -options_.restitution;
}

bool Spheres::answer(const Pair& pair, Episode& episode, double seconds) {
  Sphere& a = spheres_[pair.first];
  Sphere& b = spheres_[pair.second];
  switch (options_.answer) {
    case Answer::flip:
      if (!options_.every_frame && episode.answers > 0) return false;
      flip(a.velocity, b.velocity);
      return true;
    case Answer::impulse:
      return restitute(a.velocity, b.velocity, {1 / mass(a), 1 / mass(b)}, normal(pair), options_.restitution);
    case Answer::compliant: break;
  }
  return push(pair, episode, seconds);
}

/// One step of the pair's distance on its spring. The velocities take the whole impulse; what the two would then travel
/// too far or too little, because it came early or late in the step, goes into their places.
bool Spheres::push(const Pair& pair, Episode& episode, double seconds) {
  Sphere& a = spheres_[pair.first];
  Sphere& b = spheres_[pair.second];
  const Vec3 along = normal(pair);
  const InverseMasses masses{1 / mass(a), 1 / mass(b)};
  const double start_m = episode.deflection_m;
  const double start_m_s = along.dot(b.velocity - a.velocity);
  const double overlap_m = -gap(pair);
  between_.mass_kg[0] = 1 / masses.sum();
  between_.low_wall_m = 0;
  between_.high_wall_m = kInfinity;
  motion_.position_m[0] = start_m;
  motion_.velocity_m_s[0] = start_m_s;
  stepper_.use(between_, {.method = Method::compliant, .spring = spring_});
  stepper_.step(motion_, seconds);
  const double change_m_s = motion_.velocity_m_s[0] - start_m_s;
  const double shift_m = motion_.position_m[0] - start_m - motion_.velocity_m_s[0] * seconds;
  a.velocity -= masses.a / masses.sum() * change_m_s * along;
  b.velocity += masses.b / masses.sum() * change_m_s * along;
  shift(a, -masses.a / masses.sum() * shift_m * along);
  shift(b, masses.b / masses.sum() * shift_m * along);
  // A spring that has let go starts afresh, wherever the two are then.
  episode.deflection_m = std::min(motion_.position_m[0], 0.0);
  ledger_.penetration_m =
      std::max(ledger_.penetration_m, overlap_m + std::max(stepper_.counts().deepest_m + start_m, 0.0));
  // However many steps a contact on a spring takes, it is one answer.
  return change_m_s != 0 && episode.answers == 0;
}

/// Not into a wall: its spring would take the way for work that nobody did.
void Spheres::shift(Sphere& sphere, const Vec3& by) const {
  const double most = options_.half_side_m - sphere.radius_m;
  for (int axis = 0; axis < 3; ++axis) {
    double& at = sphere.position[axis];
    if (std::abs(at) < most) at = std::clamp(at + by[axis], -most, most);
  }
}

bool Spheres::move_on_springs(Sphere& sphere, int axis, double seconds) {
  const double most = options_.half_side_m - sphere.radius_m;
  double& at = sphere.position[axis];
  double& velocity = sphere.velocity[axis];
  if (std::abs(at) + std::abs(velocity) * seconds < most) {
    at += velocity * seconds;
    return false;
  }
  between_.mass_kg[0] = mass(sphere);
  between_.low_wall_m = -most;
  between_.high_wall_m = most;
  motion_.position_m[0] = at;
  motion_.velocity_m_s[0] = velocity;
  stepper_.use(between_, {.method = Method::compliant, .spring = spring_});
  stepper_.step(motion_, seconds);
  at = motion_.position_m[0];
  velocity = motion_.velocity_m_s[0];
  ledger_.penetration_m = std::max(ledger_.penetration_m, stepper_.counts().deepest_m);
  return stepper_.episodes().began() > 0;
}

void Spheres::move(Sphere& sphere, double seconds) {
  const double most = options_.half_side_m - sphere.radius_m;
  std::size_t components = 0;
  for (int axis = 0; axis < 3; ++axis) {
    bool turned = false;
    if (options_.answer == Answer::compliant) {
      turned = move_on_springs(sphere, axis, seconds);
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
  for (auto& [pair, episode] : open_) {
    ledger_.penetration_m = std::max(ledger_.penetration_m, -gap(pair));
    if (!answer(pair, episode, seconds)) continue;
    ++episode.answers;
    ++ledger_.flips;
  }
  for (Sphere& sphere : spheres_) move(sphere, seconds);
}

double Spheres::energy() const {
  double sum = 0;
  for (const Sphere& sphere : spheres_) sum += 0.5 * mass(sphere) * sphere.velocity.squaredNorm();
  if (options_.answer != Answer::compliant) return sum;
  const auto stored = [this](double depth_m) {
    return 0.5 * spring_.stiffness_n_m * std::max(depth_m, 0.0) * std::max(depth_m, 0.0);
  };
  for (const auto& [pair, episode] : open_) sum += stored(-episode.deflection_m);
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
  // Episodes that still hold count with what they have done so far.
  for (const auto& [pair, episode] : open_) count_episode(result, episode.answers);
  result.energy_after = energy();
  result.momentum_after = momentum();
  return result;
}

}  // namespace collided::response
