#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/world/world.hpp"
#include "tests/studies/homework/recording.hpp"

namespace collided::homework {
using namespace engine;

using ObjectPairs = std::vector<std::array<std::uint32_t, 2>>;  // lower number first, ordered

/// One way to say which objects of a recording meet, its indexes built beforehand.
class Method {
 public:
  virtual ~Method() = default;
  virtual std::string name() const = 0;
  /// Everything goes to its new place, and the method finds what meets there: this is timed.
  virtual void frame(const std::vector<Pose>& poses) = 0;
  /// Of the last frame.
  virtual ObjectPairs pairs() const = 0;
  /// Pairs of polygons that meet, for a method that finds all of them.
  virtual std::optional<std::size_t> polygon_pairs() const { return std::nullopt; }
  /// Pairs of objects that its coarse phase left to the fine one.
  virtual std::size_t candidates() const = 0;
};

/// The server's world and collision step: objects that meet, and what began and ended.
class CollidedWorld final : public Method {
 public:
  explicit CollidedWorld(const Recording& recording, bool contacts = false);
  std::string name() const override { return contacts_ ? "Collided, with contacts" : "Collided"; }
  void frame(const std::vector<Pose>& poses) override;
  ObjectPairs pairs() const override;
  std::size_t candidates() const override { return world_.cost().candidate_pairs; }
  void for_each_change(const std::function<void(std::size_t a, std::size_t b, bool began)>& change) const;
  const World& world() const { return world_; }
  std::uint32_t number_of(ObjectId id) const { return number_of_.at(id); }

 private:
  bool contacts_;
  World world_;
  std::vector<ObjectId> ids_;
  std::unordered_map<ObjectId, std::uint32_t> number_of_;
  std::unique_ptr<bool[]> moved_;
  std::int64_t time_ns_ = 0;
};

/// Null where a method cannot take so much, or its package was not there when this was built.
using MakeMethod = std::unique_ptr<Method> (*)(const Recording& recording);

std::unique_ptr<Method> collided_world(const Recording& recording);
/// V-COLLIDE's calls: all pairs of polygons.
std::unique_ptr<Method> collided_polygons(const Recording& recording);
/// The homework's own: all bounding spheres, all polygons by Moeller's test.
std::unique_ptr<Method> simple_prototype(const Recording& recording);
std::unique_ptr<Method> fcl_objects(const Recording& recording);
std::unique_ptr<Method> fcl_polygons(const Recording& recording);
std::unique_ptr<Method> bullet_objects(const Recording& recording);

}  // namespace collided::homework
