#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"
#include "collided/shown_objects.hpp"

namespace collided::client {

/// The objects of a recorded world, by name, as its samples and commands change them. Calls with recorded data throw
/// std::exception if the data is invalid, and then change nothing.
///
/// limits   kMostParts parts over all objects
/// threads  one at a time
class RecordedObjects {
 public:
  static constexpr std::size_t kMostParts = 2'000'000;

  /// surroundings  static objects that recordings do not contain; null: none
  explicit RecordedObjects(std::shared_ptr<const ShownObjects> surroundings);

  void define(const wire::Definition& definition);
  void place(const wire::PoseBatch& batch);
  /// Applies the lost policies of publishers that a status calls lost.
  void lose_lost(const wire::Status& status);
  /// Applies a command as reported by its answer.
  ///
  /// shape   bytes sent with it
  /// answer  discarded JSON if the recording has none
  void carry_out(const nlohmann::json& command, std::span<const std::uint8_t> shape, const nlohmann::json& answer);

  /// The number of the object of that name.
  std::uint64_t id_of(const std::string& name);
  bool has_new_table() const { return has_new_table_; }
  bool has_new_poses() const { return has_new_poses_; }
  /// All objects; the next table has another version.
  std::shared_ptr<const ShownObjects> table();
  /// The poses of all moving objects, for the newest table.
  Poses poses();

 private:
  using DefinedBy = std::pair<std::uint64_t, std::uint32_t>;  // publisher (0: a command) and its number of the object
  struct Object {
    ShownObject shown;
    DefinedBy by;
    std::uint8_t lost_policy = 0;
  };
  struct Attachment {
    std::string parent;
    Pose pose;  // in the parent's frame
  };

  void add(ShownObject object, const DefinedBy& by, std::span<const std::uint8_t> shape, const Vec3& scale,
           std::uint8_t lost_policy);
  void erase(const std::string& name);
  // The effects of commands.
  void add_by_command(const nlohmann::json& command, std::span<const std::uint8_t> shape);
  void move(const std::string& name, const Pose& pose);
  void remove(const std::vector<std::string>& names);
  void clear(const std::string& scene, bool is_moving_only);
  void bring_back(const std::string& scene);
  void detach(const std::string& child);

  Object* defined(const DefinedBy& by);
  const ShownObject* find(const std::string& name) const;
  std::vector<const ShownObject*> all() const;
  std::vector<std::string> named(const std::string& glob) const;
  Pose pose_of(const ShownObject& object, int depth = 0) const;

  const std::shared_ptr<const ShownObjects> surroundings_;
  std::map<std::string, const ShownObject*, std::less<>> still_;  // the present objects of the surroundings
  std::map<std::string, Object, std::less<>> objects_;
  std::map<DefinedBy, std::string> names_;                   // of objects defined by publishers
  std::map<std::string, Attachment, std::less<>> attached_;  // by the child
  std::set<std::uint64_t> lost_;                             // publishers
  std::map<std::string, std::uint64_t, std::less<>> ids_;
  std::size_t part_count_ = 0;
  std::uint64_t next_surface_;
  std::uint64_t table_version_ = 0;
  std::uint64_t version_ = 0;
  std::chrono::nanoseconds world_time_{0};
  bool has_new_table_ = false;
  bool has_new_poses_ = false;
};

}  // namespace collided::client
