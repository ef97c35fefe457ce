#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/world/query/probes.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Names of the objects in contacts that hold; `ended` events need them for objects that the world has forgotten.
class NameBook {
 public:
  /// To be called with each contact that begins before its frame is written, and forget() with each that ended
  /// afterwards.
  void note(const OpenContact& contact, const World& world);
  void forget(const OpenContact& contact);
  /// Empty where no noted contact names the object. Valid until the next note() or forget().
  std::string_view name(ObjectId id) const;
  /// The triangle's number as reported: that in the file.
  std::uint32_t triangle(ObjectId id, std::uint32_t triangle) const;

 private:
  struct Entry {
    std::string name;
    CutTriangles cut{};
    std::uint32_t part_triangles = 0;
    std::uint32_t contacts = 0;  // that hold and name it
  };
  void note(ObjectId id, const World& world);
  void forget(ObjectId id);
  std::unordered_map<ObjectId, Entry> entries_;
};

/// Ids with their names as they travel: zero-terminated UTF-8, one after the other.
struct NameTable {
  std::vector<std::uint64_t> ids;
  std::vector<std::uint8_t> names;

  void clear();
  void add_id(ObjectId id) { ids.push_back(id); }
  /// Sorts the ids, keeps each once, and appends their names.
  template <class NameOf>
  void fill(NameOf&& name_of) {
    keep_each_once();
    for (const ObjectId id : ids) append(name_of(id));
  }
  /// Adds the name of the next id.
  void append(std::string_view name);

 private:
  void keep_each_once();
};

/// The parallel sequences of an EventFrame. Their memory is reused from frame to frame.
struct EventColumns {
  std::uint64_t first_sequence = 0;  // of the first event
  std::vector<std::uint8_t> kinds, reasons, doubts, shards;
  std::vector<std::uint64_t> a, b, episodes;
  std::vector<std::uint32_t> a_triangles, b_triangles;
  std::vector<double> numbers;  // rows of kEventColumns
  NameTable named;

  void clear();
  /// is_merged  poses of one of the two were merged on the way (kPosesMerged)
  void add(const Event& event, const NameBook& book, bool is_merged = false);
  std::size_t size() const { return kinds.size(); }
};

/// The parallel sequences of a ContactShard.
struct ContactColumns {
  std::uint8_t shard = 0;
  std::vector<std::uint8_t> doubts;
  std::vector<std::uint64_t> a, b, episodes;
  std::vector<std::uint32_t> a_triangles, b_triangles;
  std::vector<std::int64_t> began_ns;
  std::vector<double> numbers;  // rows of kContactColumns
  NameTable named;

  void clear();
  void add(const OpenContact& contact, const NameBook& book);
  std::size_t size() const { return a.size(); }
  /// About what the shard takes in a message, without its fixed fields.
  std::size_t bytes() const;
};

/// The parallel sequences of a ProbeFrame.
struct ProbeColumns {
  std::vector<std::uint8_t> states;
  std::vector<std::uint64_t> objects, met;
  std::vector<std::uint32_t> triangles;
  std::vector<double> numbers;  // rows of kProbeColumns
  std::vector<std::uint8_t> probe_names;
  NameTable named;

  void clear();
  void add(std::string_view probe_name, const ProbeReading& reading);
  std::size_t size() const { return states.size(); }
};

}  // namespace collided::engine::service
