#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// A publisher's record of one of its objects, sufficient to define it again.
struct PublishedObject {
  ObjectOptions options;            // with the newest pose; without the shape
  Pose sent;                        // the pose sent last: the newest, or an earlier one if poses wait
  std::vector<std::uint8_t> shape;  // encoded
  std::uint32_t generation = 0;
  bool used = false;
  bool enters = false;  // it was outside, and enters the world with the next instant
  enum class Waiting : std::uint8_t { no, moved, teleported } waiting = Waiting::no;
};

/// The objects of a publisher, and those with poses that wait to be sent.
///
/// An object's number is a DDS key. DDS never frees a key, so the number of a removed object is reused. The upper bits
/// of an object's handle count the uses, so that an old handle finds nothing.
///
/// threads  one at a time
class PublishedObjects {
 public:
  static constexpr std::uint32_t kMost = 1u << 20;

  static std::uint32_t number(Publisher::Object object) { return object & (kMost - 1); }
  bool has_name(const std::string& name) const { return names_.contains(name); }
  /// Adds an object and returns its handle; nothing if there are kMost objects.
  std::optional<Publisher::Object> add(ObjectOptions options, std::vector<std::uint8_t> shape);
  void remove(Publisher::Object object);
  /// The object; null for a handle without an object (any more).
  PublishedObject* find(Publisher::Object object);

  /// Sets the pose to send. A newer pose replaces it; if either is a teleport, the sent pose is a teleport.
  void set_pose(Publisher::Object object, const Pose& pose, bool teleport);
  /// The numbers of objects with waiting poses. sort_waiting() moves teleports to the end and returns the number of
  /// others.
  std::span<const std::uint32_t> waiting() const { return waiting_; }
  std::size_t sort_waiting();
  /// Removes the first `count` of waiting() after they were sent.
  void mark_sent(std::size_t count);

  void note_entered(std::uint32_t number) { objects_[number].enters = false; }
  const PublishedObject& at(std::uint32_t number) const { return objects_[number]; }
  std::size_t size() const { return names_.size(); }
  std::uint32_t numbers_used() const { return static_cast<std::uint32_t>(objects_.size()); }

 private:
  std::vector<PublishedObject> objects_;  // by number
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> waiting_;  // numbers, in the order of their first move since they were sent
  std::unordered_set<std::string> names_;
};

}  // namespace collided::client
