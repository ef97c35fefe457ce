#include "client/ros/marker_objects.hpp"

#include <cmath>

#include "client/ros/placed_frame.hpp"

namespace collided::ros {
namespace {

constexpr std::size_t kMostWaiting = 10'000;
constexpr std::size_t kMostObjects = 10'000;
constexpr std::int64_t kLongestWaitNs = 1'000'000'000;

bool is_pose(const Pose& pose) {
  constexpr double kMostOff = 1e-3;  // as for transforms
  return pose.position.allFinite() && std::abs(pose.rotation.norm() - 1) <= kMostOff;
}

bool is_same_thing(const MarkerMessage& a, const MarkerMessage& b) {
  return a.type == b.type && a.scale == b.scale && a.points == b.points;
}

}  // namespace

void MarkerObjects::tell(const std::string& flaw) {
  constexpr std::size_t kMostFlaws = 100;
  if (flaws_.size() < kMostFlaws) flaws_.push_back(flaw);
}

Result<void> MarkerObjects::start() {
  if (topics_.empty()) return {};
  Result<Publisher> publisher = client_.publish("collide ros markers");
  if (!publisher) return publisher.error();
  publisher_.emplace(std::move(*publisher));
  publisher_->stream();
  return {};
}

void MarkerObjects::remove(const std::string& prefix, bool is_whole_name) {
  const auto is_meant = [&](const std::string& name) {
    return is_whole_name ? name == prefix : name.starts_with(prefix);
  };
  std::erase_if(waiting_, [&](const Waiting& waiting) { return is_meant(waiting.name); });
  std::erase_if(objects_, [&](const auto& entry) {
    if (!is_meant(entry.first)) return false;
    if (!publisher_->remove(entry.second.object)) ++counts_.unsent;
    return true;
  });
}

void MarkerObjects::take(std::size_t topic, const MarkerMessage& marker, std::int64_t now_ns) {
  ++counts_.markers;
  const std::string all = topics_[topic] + '/';
  const std::string name =
      all + (marker.name_space.empty() ? "" : marker.name_space + '/') + std::to_string(marker.number);
  if (marker.action == kDeleteAllMarkers)
    return remove(marker.name_space.empty() ? all : all + marker.name_space + '/', false);
  if (marker.action == kDeleteMarker) return remove(name, true);
  auto shape = shape_of(marker);
  if (const auto* why = std::get_if<std::string>(&shape)) {
    ++counts_.shapeless;
    tell("marker " + name + ": " + *why);
    return;
  }
  if (marker.action != kAddMarker || !is_pose(marker.pose)) {
    ++counts_.bad;
    tell("marker " + name + ": its action or pose cannot be meant");
    return;
  }
  std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.name == name; });
  if (waiting_.size() >= kMostWaiting) {
    ++counts_.frameless;
    waiting_.pop_front();
  }
  waiting_.push_back({name, marker, std::get<Shape>(std::move(shape)), now_ns});
}

void MarkerObjects::go_on(const FrameTree& frames, std::int64_t now_ns) {
  if (!publisher_) return;
  std::erase_if(objects_, [&](const auto& entry) {
    if (entry.second.ends_ns == 0 || now_ns < entry.second.ends_ns) return false;
    if (!publisher_->remove(entry.second.object)) ++counts_.unsent;
    return true;
  });
  for (std::size_t left = waiting_.size(); left > 0; --left) {
    Waiting waiting = std::move(waiting_.front());
    waiting_.pop_front();
    const PlacedFrame placed =
        place_frame(frames, fixed_, waiting.marker.frame, waiting.marker.stamp_ns, waiting.came_ns);
    if (placed.placing == FramePlacing::unnamed) {
      ++counts_.unnamed;
    } else if (placed.placing == FramePlacing::not_yet) {
      if (now_ns - waiting.came_ns > kLongestWaitNs) ++counts_.frameless;
      else waiting_.push_back(std::move(waiting));
    } else {
      counts_.unstamped += placed.is_unstamped ? 1 : 0;
      counts_.ahead += placed.is_ahead ? 1 : 0;
      place(waiting, placed.pose, now_ns);
    }
  }
  if (!publisher_->flush()) ++counts_.unsent;
}

void MarkerObjects::place(Waiting& waiting, const Pose& frame, std::int64_t now_ns) {
  const Quat turn = (frame.rotation * waiting.marker.pose.rotation).normalized();
  const Pose pose{frame.position + frame.rotation * waiting.marker.pose.position, turn};
  const bool is_new = !objects_.contains(waiting.name);
  if (is_new && objects_.size() >= kMostObjects) {
    ++counts_.bad;
    tell("more markers than " + std::to_string(kMostObjects));
    return;
  }
  MarkerObject& shown = objects_[waiting.name];
  Result<void> done;
  if (is_new) {
    const Result<Publisher::Object> added = publisher_->add(
        {.name = waiting.name, .shape = waiting.shape, .pose = pose, .lost_policy = LostPolicy::freeze});
    if (added) shown.object = *added;
    else done = added.error();
  } else {
    done = show(shown, waiting, pose);
  }
  if (!done) {
    ++counts_.unsent;
    tell("marker " + waiting.name + ": " + done.error().message);
    if (is_new) objects_.erase(waiting.name);
    return;
  }
  shown.ends_ns = waiting.marker.lifetime_ns > 0 ? now_ns + waiting.marker.lifetime_ns : 0;
  shown.marker = std::move(waiting.marker);
}

Result<void> MarkerObjects::show(MarkerObject& shown, Waiting& waiting, const Pose& pose) {
  if (!is_same_thing(shown.marker, waiting.marker)) {
    if (Result<void> reshaped = publisher_->reshape(shown.object, waiting.shape); !reshaped) return reshaped;
  }
  return publisher_->move(shown.object, pose);
}

}  // namespace collided::ros
