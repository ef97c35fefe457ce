#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/geometry/pose.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// The parent of each attached object.
using ParentOf = std::unordered_map<ObjectId, ObjectId>;

/// An object that moves along with another.
struct AttachedObject {
  ObjectId child = 0;
  ObjectId parent = 0;
  // A redefined object has a new id and the same name, and stays attached.
  std::string child_name;
  std::string parent_name;
  Pose in_parent;  // of the child, in the parent's frame
};

/// Which objects move along with which.
/// threads  writer only, except table()
/// Always: an object has at most one parent and is never its own ancestor.
class Attachments {
 public:
  static constexpr std::size_t kMost = 1'000;

  bool empty() const { return attached_.empty(); }
  const std::vector<AttachedObject>& all() const { return attached_; }
  /// Null if the object is not attached.
  const AttachedObject* find(ObjectId child) const;
  bool is_parent(ObjectId id) const;
  /// True if the object is `other` or is attached to it, directly or through other objects.
  bool follows(ObjectId id, ObjectId other) const;
  /// Calls visit(attached) for each object attached directly to this one.
  template <class Visit>
  void for_each_child(ObjectId parent, Visit&& visit) const {
    if (slot_of(parent) >= children_.size()) return;
    for (const std::uint32_t index : children_[slot_of(parent)]) {
      if (attached_[index].parent == parent) visit(attached_[index]);
    }
  }

  void add(AttachedObject attached);
  void replace(std::size_t index, ObjectId child, ObjectId parent);
  void remove(ObjectId child);

  /// For readers: replaced on every change; null if nothing is attached.
  const std::shared_ptr<const ParentOf>& table() const { return table_; }

 private:
  void index();

  std::vector<AttachedObject> attached_;
  std::vector<std::vector<std::uint32_t>> children_;  // indexes into attached_, by the parent's slot
  std::shared_ptr<const ParentOf> table_;
};

}  // namespace collided::engine
