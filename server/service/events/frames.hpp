#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "idl/messages.hpp"
#include "server/world/query/probes.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Names of the objects in open contacts; `ended` events need them for objects that the world has forgotten.
class NameBook {
 public:
  /// Call this with each contact that begins before its frame is written, and forget() with each that ended afterwards.
  void note(const OpenContact& contact, const World& world);
  void forget(const OpenContact& contact);
  /// The same for one object.
  void note(ObjectId id, const World& world);
  void forget(ObjectId id);
  /// Empty if no noted contact names the object. Valid until the next note() or forget().
  std::string_view name(ObjectId id) const;
  /// The triangle's number as reported: that in the file.
  std::uint32_t triangle(ObjectId id, std::uint32_t triangle) const;

 private:
  struct Entry {
    std::string name;
    CutTriangles cut{};
    std::uint32_t part_triangles = 0;
    std::uint32_t contacts = 0;  // open ones that name it
  };
  std::unordered_map<ObjectId, Entry> entries_;
};

using wire::put;
/// Adds a name to those that accompany their ids: zero-terminated UTF-8, one after the other.
void put(std::vector<std::uint8_t>& names, std::string_view name);

/// Sorts the ids that a message names, keeps each once, and adds their names.
template <class Columns, class NameOf>
void put_names(Columns& columns, const NameOf& name_of) {
  std::vector<ObjectId>& ids = columns.named_ids;
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const ObjectId id : ids) put(columns.names, name_of(id));
}

// The columns of messages. Their memory is reused from message to message.

struct EventColumns : wire::EventFrameColumns {
  std::uint64_t first_sequence = 0;  // of the first event

  /// poses of one of the two were merged on the path (kDoubtPosesMerged)
  void add(const Event& event, const NameBook& book, bool is_merged = false);
  std::size_t size() const { return kinds.size(); }
};

struct ContactColumns : wire::ContactShardColumns {
  std::uint8_t shard = 0;

  void add(const OpenContact& contact, const NameBook& book);
  std::size_t size() const { return a.size(); }
  /// Approximate size of the shard in a message, without its fixed fields.
  std::size_t bytes() const;
};

struct ProbeColumns : wire::ProbeFrameColumns {
  void add(std::string_view probe_name, const ProbeReading& reading);
  std::size_t size() const { return states.size(); }
};

}  // namespace collided::engine::service
