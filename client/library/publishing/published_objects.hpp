#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// What a publisher knows of one of its objects: enough to define it anew.
struct PublishedObject {
  ObjectOptions options;  // pose: the newest; shape: left empty once encoded
  std::vector<std::uint8_t> shape;
  std::uint32_t generation = 0;
  bool used = false;
  enum class Waiting : std::uint8_t { no, moved, teleported } waiting = Waiting::no;
};

/// The objects of a publisher and the poses that wait to be sent. The numbers on the wire are keys, and DDS never
/// forgets a key, so a removed object's number goes to the next one; the handle carries a count of such uses in its
/// upper bits and a stale handle finds nothing. One thread at a time.
class PublishedObjects {
 public:
  static constexpr std::uint32_t kMost = 1u << 20;

  static std::uint32_t number(Publisher::Object object) { return object & (kMost - 1); }
  bool has_name(const std::string& name) const { return names_.contains(name); }
  /// Nothing when kMost objects live.
  std::optional<Publisher::Object> add(ObjectOptions options, std::vector<std::uint8_t> shape);
  void remove(Publisher::Object object);
  /// Null for a handle that names nothing (any more).
  PublishedObject* find(Publisher::Object object);

  /// The newest pose wins; once a teleport, it stays one until sent.
  void set_pose(Publisher::Object object, const Pose& pose, bool teleport);
  /// Numbers whose poses wait. sort_waiting() puts teleports last and returns how many stand before them.
  std::span<const std::uint32_t> waiting() const { return waiting_; }
  std::size_t sort_waiting();
  /// The first `count` of waiting() were sent.
  void mark_sent(std::size_t count);

  const PublishedObject& at(std::uint32_t number) const { return objects_[number]; }
  std::size_t size() const { return names_.size(); }
  std::uint32_t numbers_used() const { return static_cast<std::uint32_t>(objects_.size()); }

 private:
  std::vector<PublishedObject> objects_;  // by number
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> waiting_;  // numbers in order of their first move
  std::unordered_set<std::string> names_;
};

}  // namespace collided::client
