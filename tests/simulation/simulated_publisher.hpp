#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "server/service/ingest/publishers.hpp"
#include "server/service/ingest/samples.hpp"

namespace collided::simulation {
using namespace engine;

/// A publisher's clock: off the server's, too fast or too slow, coarse, set anew at times.
class SimulatedClock {
 public:
  SimulatedClock(std::mt19937_64& random, std::int64_t now_ns);
  /// One that is less than a lease from every other of its kind for a quarter of a minute.
  static SimulatedClock near(std::mt19937_64& random, std::int64_t now_ns);

  /// The same twice where it is coarser than the calls.
  std::int64_t stamp(std::int64_t now_ns) const;
  void jump(std::int64_t by_ns) { offset_ns_ += by_ns; }
  /// Puts it right by less than a lease.
  void correct(std::int64_t by_ns) {
    correction_ns_ = std::clamp(correction_ns_ + by_ns, -kMostCorrectionNs, kMostCorrectionNs);
  }

 private:
  SimulatedClock(std::int64_t since_ns, std::int64_t offset_ns, double drift, std::int64_t resolution_ns)
      : since_ns_(since_ns), offset_ns_(offset_ns), drift_(drift), resolution_ns_(resolution_ns) {}

  static constexpr std::int64_t kMostCorrectionNs = wire_contract::kPublisherLeaseNs / 2;

  std::int64_t since_ns_;
  std::int64_t correction_ns_ = 0;
  std::int64_t offset_ns_ = 0;
  double drift_ = 0;
  std::int64_t resolution_ns_ = 1;
};

/// A publisher as the client library is one: definitions and poses under one count, everything defined anew after a
/// hang, a restart or with a new server. What it believes to have said is the truth that the world is held against.
class SimulatedPublisher {
 public:
  struct Object {
    std::string name;
    Vec3 position = Vec3::Zero();
    Vec3 sent = Vec3::Zero();  // where it was said to be last
    double radius_m = 0.5;
    LostPolicy policy = LostPolicy::remove;
    bool is_moved = false;  // since the last flush
  };

  SimulatedPublisher(std::uint64_t id, std::uint64_t incarnation, const SimulatedClock& clock)
      : id_(id), incarnation_(incarnation), clock_(clock) {}

  std::uint64_t id() const { return id_; }
  const std::map<std::uint32_t, Object>& objects() const { return objects_; }
  Object& object(std::uint32_t number) { return objects_.at(number); }
  bool has_name(const std::string& name) const;

  service::DefinitionSample add(const Object& object);
  service::DefinitionSample remove(std::uint32_t number);
  /// Every object where it was said to be last, as after a hang; what has moved since waits for the next flush.
  std::vector<service::DefinitionSample> define_all();
  void move(std::uint32_t number, const Vec3& position);
  /// The poses that were moved since the last flush; all of them where `everything`.
  service::PoseSample flush(std::int64_t now_ns, bool teleported, bool everything);
  /// A batch of nothing, as a sign of life behind definitions.
  service::PoseSample word();
  SimulatedClock& clock() { return clock_; }

 private:
  service::DefinitionSample definition(std::uint32_t number, bool removed);

  std::uint64_t id_;
  std::uint64_t incarnation_;
  SimulatedClock clock_;
  std::uint64_t sequence_ = 0;
  std::uint64_t definitions_through_ = 0;
  std::map<std::uint32_t, Object> objects_;
};

}  // namespace collided::simulation
