#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/world.hpp"

namespace collided::model {
using namespace engine;

/// What a World is told, kept plainly: by name, without an index, a slot, a table or a cache. Whatever a long-lived World
/// says is compared with one that is made from this just now, which has no past.
class PlainWorld {
 public:
  struct Object {
    ObjectDefinition definition;  // with the newest pose
    Pose before;                  // the way to it began here
    std::int64_t before_ns = 0;
    std::int64_t posed_ns = 0;
    bool is_shown = false;  // a step has seen it
    bool has_motion = false;
    bool is_stale = false;
    bool moved_while_stale = false;
  };
  /// Whether the object of this name and layers is part of the made world.
  using Allows = std::function<bool(std::string_view, std::uint32_t)>;

  void add_scene(const Scene& scene);
  void remove_scene(const std::string& name);
  void state_covers(const std::string& scene, const std::vector<Aabb>& boxes) { covers_[scene] = boxes; }
  void define(const ObjectDefinition& definition);
  void remove(const std::string& name) { objects_.erase(name); }
  void move(const std::string& name, const Pose& pose, std::int64_t time_ns, bool teleport);
  void set_stale(const std::string& name, bool is_stale);
  void stepped(std::int64_t now_ns);

  /// A world in this state. Its objects come in the given order, so that which of two has the lower id is as asked.
  std::unique_ptr<World> make(std::span<const std::string> order, const Allows& allows = {}) const;

  const std::map<std::string, Object>& objects() const { return objects_; }
  const std::vector<Scene>& scenes() const { return scenes_; }
  bool has_scene(std::string_view name) const;
  bool has_name(const std::string& name) const;
  std::int64_t now_ns() const { return now_ns_; }
  bool is_covered_everywhere() const { return covers_.empty() && !was_covered_; }
  bool has_stale() const;

 private:
  static Scene allowed_parts(const Scene& scene, const Allows& allows);
  void place_objects(World& world, std::span<const std::string> order, const Allows& allows) const;

  std::map<std::string, Object> objects_;
  std::vector<Scene> scenes_;  // without objects: those are in objects_
  std::map<std::string, std::vector<Aabb>> covers_;
  bool was_covered_ = false;
  std::int64_t now_ns_ = 0;
};

}  // namespace collided::model
