#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "collided/client.hpp"

namespace collided::client {

/// What a publisher knows of one of its objects, which is enough to define it again.
struct PublishedObject {
  ObjectOptions options;            // with the newest pose; without the shape
  Pose sent;                        // the pose that was sent last: the newest, or one from before those that wait
  std::vector<std::uint8_t> shape;  // encoded
  std::uint32_t generation = 0;
  bool used = false;
  bool enters = false;  // it was elsewhere, and enters the world with the next instant
  enum class Waiting : std::uint8_t { no, moved, teleported } waiting = Waiting::no;
};

/// The objects of a publisher, and which of them have poses that wait to be sent.
///
/// An object's number is a DDS key, and DDS never forgets a key, so the number of a removed object is used again. The
/// object's handle has a count of such uses in its upper bits, so that an old handle finds nothing.
///
/// threads  one at a time
class PublishedObjects {
 public:
  static constexpr std::uint32_t kMost = 1u << 20;

  static std::uint32_t number(Publisher::Object object) { return object & (kMost - 1); }
  bool has_name(const std::string& name) const { return names_.contains(name); }
  /// Adds an object and returns its handle; nothing where there are kMost objects.
  std::optional<Publisher::Object> add(ObjectOptions options, std::vector<std::uint8_t> shape);
  void remove(Publisher::Object object);
  /// The object; null for a handle that is not (any more) that of one.
  PublishedObject* find(Publisher::Object object);

  /// Sets the pose to be sent. A newer pose replaces it; if one of them is a teleport, what is sent is a teleport.
  void set_pose(Publisher::Object object, const Pose& pose, bool teleport);
  /// The numbers of the objects whose poses wait. sort_waiting() moves teleports to the end and returns how many others
  /// there are.
  std::span<const std::uint32_t> waiting() const { return waiting_; }
  std::size_t sort_waiting();
  /// Removes the first `count` of waiting(), which were sent.
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
