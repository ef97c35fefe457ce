#include "server/world/query/probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "server/geometry/float_environment.hpp"
#include "server/world/query/covered.hpp"
#include "server/world/query/question.hpp"

namespace collided::engine {

namespace {

bool same(const Filter& a, const Filter& b) { return a.layers == b.layers && a.mask == b.mask && a.group == b.group; }

/// Casts the ray of one probe, with a limit that differs between calls.
struct ProbeRay {
  const Snapshot& snapshot;
  const std::vector<std::uint8_t>& allowed;
  const std::vector<std::uint8_t>& open_scenes;
  std::vector<AnswerHit>& found;
  double numbers[kRayNumbers];
  bool undecided = false;

  const AnswerHit* first_within(double length_m) {
    const Questions asked;
    numbers[6] = length_m;
    Question question{
        .snapshot = snapshot, .asked = asked, .allowed = allowed, .open_scenes = open_scenes, .found = found};
    ask_ray(question, numbers);
    undecided = undecided || question.undecided;
    return found.empty() ? nullptr : &found.front();
  }

  /// The sign of the first hit's distance less that length, exactly: compares with hits within the length and within
  /// the next smaller double.
  ProbeState state_about(double length_m) {
    if (first_within(length_m) == nullptr) return ProbeState::gap;
    const bool is_nearer = length_m > 0 && first_within(std::nextafter(length_m, 0.0)) != nullptr;
    return is_nearer ? ProbeState::collision : ProbeState::touching;
  }
};

/// Gives the rounded number the sign of the state, which is exact.
void agree_with_sign(ProbeReading& reading) {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  if (reading.state == ProbeState::touching) reading.clearance_m = reading.error_m = 0;
  if (reading.state == ProbeState::gap) reading.clearance_m = std::max(reading.clearance_m, kLeast);
  if (reading.state == ProbeState::collision) reading.clearance_m = std::min(reading.clearance_m, -kLeast);
}

}  // namespace

std::optional<Refusal> Probes::set(const ProbeDefinition& definition) {
  const double length = definition.direction.stableNorm();
  if (!definition.origin.allFinite() || !std::isfinite(length)) return Refusal{"probe: a number is not finite"};
  if (!(length > 0)) return Refusal{"probe: direction 0 0 0 has no direction"};
  if (!(definition.reach_m >= 0)) return Refusal{"probe: the reach is below 0"};
  if (!(definition.back_m >= 0 && std::isfinite(definition.back_m)))
    return Refusal{"probe: looking back must be from 0 on, and have an end"};
  const Vec3 unit = definition.direction.stableNormalized();
  Probe probe{.definition = definition, .start = definition.origin - definition.back_m * unit, .direction = unit};
  if (!probe.start.allFinite()) return Refusal{"probe: it begins beyond the range of double"};
  is_bound_ = false;
  const auto known = std::find_if(probes_.begin(), probes_.end(),
                                  [&](const Probe& other) { return other.definition.name == definition.name; });
  if (known != probes_.end()) {
    *known = std::move(probe);
    return std::nullopt;
  }
  if (probes_.size() >= kMaxProbes) {
    return Refusal{"probe: there are " + std::to_string(probes_.size()) + ", the limit. Nothing was added"};
  }
  probes_.push_back(std::move(probe));
  return std::nullopt;
}

std::vector<std::string> Probes::remove(std::string_view glob) {
  std::vector<std::string> names;
  const auto goes = [&](const Probe& probe) {
    if (!glob_matches(glob, probe.definition.name)) return false;
    names.push_back(probe.definition.name);
    return true;
  };
  probes_.erase(std::remove_if(probes_.begin(), probes_.end(), goes), probes_.end());
  return names;
}

/// Looks names and filters up once per object table, not once per step.
void Probes::bind(const Snapshot& snapshot, const Find& find) {
  if (is_bound_ && bound_version_ == snapshot.objects.version()) return;
  for (Probe& probe : probes_) {
    const std::optional<ObjectId> id = find(probe.definition.object);
    probe.object = id && snapshot.objects.find(*id) != nullptr ? *id : 0;
  }
  unknown_.is_any = snapshot.objects.counts().unknown > 0;
  if (unknown_.is_any)
    unknown_.objects.follow(snapshot.objects, [](const ObjectInfo& info) { return info.is_unknown; });
  unknown_.scenes.assign(snapshot.scenes.size(), 0);
  bound_version_ = snapshot.objects.version();
  is_bound_ = true;
}

Probes::Audience& Probes::audience_of(const Snapshot& snapshot, const ObjectInfo& object) {
  const auto known = std::find_if(audiences_.begin(), audiences_.end(), [&](const Audience& audience) {
    return same(audience.filter, object.filter) && audience.partners == object.rare->allowed;
  });
  if (known != audiences_.end() && known->table_version == snapshot.objects.version()) return *known;
  // There are usually few filters. If there are many, memory must not grow with them.
  constexpr std::size_t kMost = 64;
  if (known == audiences_.end() && audiences_.size() >= kMost) audiences_.clear();
  Audience& audience = known != audiences_.end() ? *known : audiences_.emplace_back();
  audience.filter = object.filter;
  audience.partners = object.rare->allowed;
  audience.allowed.follow(snapshot.objects, [&](const ObjectInfo& other) { return may_meet(object, other); });
  if (audience.parts_version != snapshot.objects.parts_version())
    mark_open_scenes(snapshot.scenes, audience.allowed.by_slot(), audience.open_scenes);
  audience.table_version = snapshot.objects.version();
  audience.parts_version = snapshot.objects.parts_version();
  return audience;
}

bool Probes::reaches_unknown_space(const Snapshot& snapshot, const Vec3& start, const Vec3& direction,
                                   double length_m) {
  if (!unknown_.is_any) return false;
  const Questions asked;
  std::vector<AnswerHit> none;
  Question question{.snapshot = snapshot,
                    .asked = asked,
                    .allowed = unknown_.objects.by_slot(),
                    .open_scenes = unknown_.scenes,
                    .found = none};
  const std::array<double, kRayNumbers> ray{start.x(),     start.y(),     start.z(), direction.x(),
                                            direction.y(), direction.z(), length_m};
  return reaches_unknown(question, ray.data(), unknown_).has_value();
}

ProbeReading Probes::read(const Snapshot& snapshot, const Probe& probe) {
  ProbeReading reading{.object = probe.object};
  if (probe.object == 0) return reading;
  const std::uint32_t slot = slot_of(probe.object);
  const Frame frame = snapshot.frame(slot);
  const Vec3 start = place(frame, probe.start);
  const Vec3 direction = place(Frame{.rotation = frame.rotation}, probe.direction);
  const ObjectInfo& info = *snapshot.objects[slot];
  Audience& audience = audience_of(snapshot, info);
  // A scene that contains the object itself is not open: its parts are filtered one by one.
  const bool is_part = info.scene_part != kNoScenePart;
  const std::vector<std::uint8_t> closed_scenes(is_part ? snapshot.scenes.size() : 0, 0);
  std::uint8_t& itself = audience.allowed[slot];
  const std::uint8_t met_by_others = std::exchange(itself, std::uint8_t{0});
  ProbeRay ray{snapshot,
               audience.allowed.by_slot(),
               is_part ? closed_scenes : audience.open_scenes,
               found_,
               {start.x(), start.y(), start.z(), direction.x(), direction.y(), direction.z(), 0}};
  const double back_m = probe.definition.back_m;
  const AnswerHit* first = ray.first_within(back_m + probe.definition.reach_m);
  reading.state = ProbeState::nothing;
  if (first != nullptr) {
    const AnswerHit hit = *first;
    reading.met = hit.object;
    reading.triangle = hit.triangle;
    reading.point = hit.point;
    reading.normal = hit.normal;
    reading.clearance_m = hit.distance_m - back_m;
    reading.error_m =
        hit.error_m + (back_m == 0 ? 0 : std::numeric_limits<double>::epsilon() * std::abs(reading.clearance_m));
    if ((hit.flags & kHitInside) != 0) reading.state = ProbeState::deeper;
    else if (std::abs(reading.clearance_m) > reading.error_m)
      reading.state = reading.clearance_m > 0 ? ProbeState::gap : ProbeState::collision;
    else reading.state = ray.state_about(back_m);
    agree_with_sign(reading);
  }
  // The space up to the hit, or to the end of the ray, must be covered by loaded geometry.
  const double known_m = back_m + (first == nullptr ? probe.definition.reach_m : reading.clearance_m - reading.error_m);
  const bool is_known = !reaches_unknown_space(snapshot, start, direction, std::max(0.0, known_m));
  const bool is_covered =
      !snapshot.covers || !leaves_covered(Ray{start, direction, std::max(0.0, known_m)}, *snapshot.covers);
  if (ray.undecided || !is_covered || !is_known) reading.state = ProbeState::undecided;
  itself = met_by_others;
  return reading;
}

void Probes::read(const Snapshot& snapshot, const Find& find, std::vector<ProbeReading>& readings) {
  readings.clear();
  if (probes_.empty()) return;
  const OwnFloatEnvironment own_floats;
  bind(snapshot, find);
  for (const Probe& probe : probes_) readings.push_back(read(snapshot, probe));
}

}  // namespace collided::engine
