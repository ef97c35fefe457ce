#include "tests/simulation/simulated_publisher.hpp"

#include <algorithm>
#include <array>

namespace collided::simulation {
using namespace engine;

using service::DefinitionSample;
using service::PoseSample;

SimulatedClock::SimulatedClock(std::mt19937_64& random, std::int64_t now_ns) : since_ns_(now_ns) {
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  // What clocks of one machine differ by, those of a network, and those of another epoch altogether.
  const double kind = in(0, 1);
  const double most_ns = kind < 0.5 ? 1e6 : 0.9 * wire_contract::kPublisherLeaseNs;
  offset_ns_ = static_cast<std::int64_t>(in(-most_ns, most_ns)) - (kind > 0.8 ? 1'000'000'000'000 : 0);
  drift_ = in(0, 1) < 0.5 ? 0 : in(-0.02, 0.02);
  resolution_ns_ = std::array<std::int64_t, 3>{1, 1'000'000, 25'000'000}[random() % 3];
}

SimulatedClock SimulatedClock::near(std::mt19937_64& random, std::int64_t now_ns) {
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const double most_ns = in(0, 1) < 0.5 ? 1e6 : 0.3 * wire_contract::kPublisherLeaseNs;
  const auto offset_ns = static_cast<std::int64_t>(in(-most_ns, most_ns));
  const double drift = in(0, 1) < 0.5 ? 0 : in(-0.005, 0.005);
  return {now_ns, offset_ns, drift, random() % 2 == 0 ? 1 : 1'000'000};
}

std::int64_t SimulatedClock::stamp(std::int64_t now_ns) const {
  const auto drifted_ns = static_cast<std::int64_t>(drift_ * static_cast<double>(now_ns - since_ns_));
  const std::int64_t time_ns = now_ns + offset_ns_ + correction_ns_ + drifted_ns;
  return time_ns - time_ns % resolution_ns_;
}

bool SimulatedPublisher::has_name(const std::string& name) const {
  return std::any_of(objects_.begin(), objects_.end(), [&](const auto& entry) { return entry.second.name == name; });
}

DefinitionSample SimulatedPublisher::definition(std::uint32_t number, bool removed) {
  DefinitionSample sample;
  sample.publisher = id_;
  sample.object_number = number;
  sample.incarnation = incarnation_;
  sample.sequence = ++sequence_;
  sample.removed = removed;
  sample.publisher_name = "publisher " + std::to_string(id_);
  definitions_through_ = sequence_;
  if (removed) return sample;
  Object& object = objects_.at(number);
  sample.name = object.name;
  sample.lost_policy = static_cast<std::uint8_t>(object.policy);
  std::copy(object.sent.begin(), object.sent.end(), sample.pose.begin());
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = object.radius_m});
  sample.shape = std::move(shape);
  return sample;
}

DefinitionSample SimulatedPublisher::add(const Object& object) {
  std::uint32_t number = 0;
  while (objects_.contains(number)) ++number;
  objects_.emplace(number, object).first->second.sent = object.position;
  return definition(number, false);
}

DefinitionSample SimulatedPublisher::remove(std::uint32_t number) {
  objects_.erase(number);
  return definition(number, true);
}

std::vector<DefinitionSample> SimulatedPublisher::define_all() {
  std::vector<DefinitionSample> all;
  for (const auto& [number, object] : objects_) all.push_back(definition(number, false));
  return all;
}

void SimulatedPublisher::move(std::uint32_t number, const Vec3& position) {
  Object& object = objects_.at(number);
  object.position = position;
  object.is_moved = true;
}

PoseSample SimulatedPublisher::word() {
  PoseSample sample;
  sample.publisher = id_;
  sample.incarnation = incarnation_;
  sample.sequence = ++sequence_;
  sample.definitions_through = definitions_through_;
  return sample;
}

PoseSample SimulatedPublisher::flush(std::int64_t now_ns, bool teleported, bool everything) {
  PoseSample sample;
  sample.publisher = id_;
  sample.incarnation = incarnation_;
  sample.sequence = ++sequence_;
  sample.definitions_through = definitions_through_;
  sample.source_time_ns = clock_.stamp(now_ns);
  sample.flags = teleported ? wire_contract::kPosesTeleported : 0;
  for (auto& [number, object] : objects_) {
    if (!object.is_moved && !everything) continue;
    object.is_moved = false;
    object.sent = object.position;
    sample.object_numbers.push_back(number);
    sample.poses.insert(sample.poses.end(), object.position.begin(), object.position.end());
    sample.poses.insert(sample.poses.end(), {1, 0, 0, 0});
  }
  return sample;
}

}  // namespace collided::simulation
