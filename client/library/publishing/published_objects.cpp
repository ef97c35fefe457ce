#include "client/library/publishing/published_objects.hpp"

#include <algorithm>

namespace collided::client {

using Waiting = PublishedObject::Waiting;

std::optional<Publisher::Object> PublishedObjects::add(ObjectOptions options, std::vector<std::uint8_t> shape) {
  std::uint32_t number = numbers_used();
  if (!free_.empty()) {
    number = free_.back();
    free_.pop_back();
  } else if (number == kMost) {
    return std::nullopt;
  } else {
    objects_.emplace_back();
  }
  names_.insert(options.name);
  PublishedObject& object = objects_[number];
  object.options = std::move(options);
  object.options.shape.clear();
  object.sent = object.options.pose;
  object.shape = std::move(shape);
  object.used = true;
  object.waiting = Waiting::no;
  return number | (object.generation * kMost);  // the generation wraps after 4,096
}

void PublishedObjects::remove(Publisher::Object handle) {
  PublishedObject& object = objects_[number(handle)];
  names_.erase(object.options.name);
  if (object.waiting != Waiting::no) { std::erase(waiting_, number(handle)); }
  const std::uint32_t generation = object.generation + 1;
  object = {};
  object.generation = generation;
  free_.push_back(number(handle));
}

PublishedObject* PublishedObjects::find(Publisher::Object handle) {
  if (number(handle) >= objects_.size()) { return nullptr; }
  PublishedObject& object = objects_[number(handle)];
  return object.used && (object.generation * kMost) == (handle & ~(kMost - 1)) ? &object : nullptr;
}

void PublishedObjects::set_pose(Publisher::Object handle, const Pose& pose, bool teleport) {
  PublishedObject& object = objects_[number(handle)];
  object.options.pose = pose;
  if (object.waiting == Waiting::no) { waiting_.push_back(number(handle)); }
  object.waiting = teleport || object.waiting == Waiting::teleported ? Waiting::teleported : Waiting::moved;
}

std::size_t PublishedObjects::sort_waiting() {
  const auto teleports = std::stable_partition(waiting_.begin(), waiting_.end(), [this](std::uint32_t number) {
    return objects_[number].waiting == Waiting::moved;
  });
  return static_cast<std::size_t>(teleports - waiting_.begin());
}

void PublishedObjects::mark_sent(std::size_t count) {
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
  std::for_each(waiting_.begin(), end, [this](std::uint32_t number) {
    PublishedObject& object = objects_[number];
    object.waiting = Waiting::no;
    object.sent = object.options.pose;
  });
  waiting_.erase(waiting_.begin(), end);
}

}  // namespace collided::client
