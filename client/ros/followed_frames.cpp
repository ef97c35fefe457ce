#include "client/ros/followed_frames.hpp"

#include <algorithm>

#include "idl/glob.hpp"

namespace collided::ros {

FollowedFrames::FollowedFrames(Client& client, Publisher& publisher, FollowedFramesOptions options)
    : client_(client), publisher_(publisher), options_(std::move(options)) {
  publisher_.stream();
}

std::string FollowedFrames::frame_of(const std::string& object, const FrameTree& frames) {
  if (frames.has(object)) return object;
  const std::string last = object.substr(object.rfind('/') + 1);
  return frames.has(last) ? last : std::string();
}

Result<std::size_t> FollowedFrames::find_objects(const FrameTree& frames) {
  const Result<ObjectList> listed = client_.list({.limit = 1'000'000});
  if (!listed) return listed.error();
  std::size_t found = 0;
  static_count_ = 0;
  for (const ListedObject& object : listed->objects) {
    if (numbers_.contains(object.name)) continue;
    if (!options_.only.empty() && !wire_contract::glob_matches(options_.only, object.name)) continue;
    const std::string frame = frame_of(object.name, frames);
    if (frame.empty() || !object.publisher.empty()) continue;
    static_count_ += object.moving ? 0 : 1;
    if (!object.moving) continue;
    const std::optional<std::int64_t> stamp_ns = frames.newest_common(options_.fixed, frame);
    const std::optional<Pose> pose = stamp_ns ? frames.lookup(options_.fixed, frame, *stamp_ns) : std::nullopt;
    if (!pose) continue;
    const Result<Publisher::Object> claimed = publisher_.claim(object.name, *pose, options_.lost_policy);
    if (!claimed) return claimed.error();
    numbers_.emplace(object.name, objects_.size());
    objects_.push_back({frame, *claimed, 0});
    ++found;
  }
  if (found > 0) {
    if (const Result<void> applied = publisher_.wait_applied(std::chrono::seconds(2)); !applied) return applied.error();
  }
  return found;
}

std::size_t FollowedFrames::send(const FrameTree& frames, std::int64_t now_ns) {
  due_.clear();
  missing_count_ = 0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const std::optional<std::int64_t> newest_ns = frames.newest_common(options_.fixed, objects_[i].frame);
    missing_count_ += newest_ns ? 0 : 1;
    if (!newest_ns || *newest_ns <= objects_[i].sent_ns) continue;
    if (const std::optional<Pose> pose = frames.lookup(options_.fixed, objects_[i].frame, *newest_ns))
      due_.push_back({*newest_ns == kAlways ? now_ns : *newest_ns, i, *pose});
    objects_[i].sent_ns = *newest_ns;
  }
  // Poses of one instant go together, the oldest first.
  std::stable_sort(due_.begin(), due_.end(), [](const Due& a, const Due& b) { return a.stamp_ns < b.stamp_ns; });
  for (std::size_t at = 0; at < due_.size(); ++at) {
    if (!publisher_.move(objects_[due_[at].object].object, due_[at].pose)) ++unsent_;
    const bool is_last = at + 1 == due_.size() || due_[at + 1].stamp_ns != due_[at].stamp_ns;
    if (is_last && !publisher_.flush(std::chrono::nanoseconds(due_[at].stamp_ns))) ++unsent_;
  }
  return due_.size();
}

}  // namespace collided::ros
