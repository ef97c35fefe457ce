#include "client/ros/frame_tree.hpp"

#include <algorithm>
#include <cmath>

namespace collided::ros {
namespace {

std::string_view without_slash(std::string_view name) { return name.starts_with('/') ? name.substr(1) : name; }

Pose product(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB.position + X_AB.rotation * X_BC.position, (X_AB.rotation * X_BC.rotation).normalized()};
}

Pose inverse(const Pose& X_AB) {
  const Quat back = X_AB.rotation.conjugate();
  return {-(back * X_AB.position), back};
}

}  // namespace

std::uint32_t FrameTree::find(std::string_view name) const {
  const auto found = numbers_.find(std::string(without_slash(name)));
  return found == numbers_.end() ? kNone : found->second;
}

std::uint32_t FrameTree::found_or_made(std::string_view name) {
  const auto [entry, is_new] =
      numbers_.emplace(std::string(without_slash(name)), static_cast<std::uint32_t>(frames_.size()));
  if (is_new) {
    frames_.emplace_back();
    names_.push_back(entry->first);
  }
  return entry->second;
}

bool FrameTree::is_above(std::uint32_t ancestor, std::uint32_t frame) const {
  for (std::uint32_t at = frame; at != kNone; at = frames_[at].parent) {
    if (at == ancestor) return true;
  }
  return false;
}

FrameTree::TransformFate FrameTree::set(std::string_view parent, std::string_view child, std::int64_t stamp_ns,
                                        const Pose& X_PC) {
  constexpr double kMostOff = 1e-3;  // transforms that were stored in single precision and multiplied
  if (without_slash(parent).empty() || without_slash(child).empty()) return TransformFate::unnamed;
  if (without_slash(parent) == without_slash(child)) return TransformFate::unnamed;
  if (!X_PC.position.allFinite() || !(std::abs(X_PC.rotation.norm() - 1) <= kMostOff)) return TransformFate::bad;
  const std::size_t added = (find(parent) == kNone ? 1 : 0) + (find(child) == kNone ? 1 : 0);
  if (frames_.size() + added > kMostFrames) return TransformFate::full;
  const std::uint32_t above = found_or_made(parent);
  const std::uint32_t below = found_or_made(child);
  if (is_above(below, above)) return TransformFate::loop;
  KnownFrame& frame = frames_[below];
  const bool was_static = !frame.instants.empty() && frame.instants.back().stamp_ns == kAlways;
  if (frame.parent != above || was_static != (stamp_ns == kAlways)) frame.instants.clear();
  frame.parent = above;
  const StampedPose instant{stamp_ns, {X_PC.position, X_PC.rotation.normalized()}};
  if (!frame.instants.empty() && stamp_ns < frame.instants.back().stamp_ns - kHistoryNs) return TransformFate::late;
  const auto place =
      std::lower_bound(frame.instants.begin(), frame.instants.end(), stamp_ns,
                       [](const StampedPose& other, std::int64_t time) { return other.stamp_ns < time; });
  if (place != frame.instants.end() && place->stamp_ns == stamp_ns) *place = instant;
  else frame.instants.insert(place, instant);
  while (frame.instants.size() > kMostInstants ||
         frame.instants.front().stamp_ns < frame.instants.back().stamp_ns - kHistoryNs)
    frame.instants.pop_front();
  return TransformFate::yes;
}

std::optional<FrameTree::Chains> FrameTree::chains(std::string_view fixed, std::string_view frame) const {
  const std::uint32_t from = find(fixed), to = find(frame);
  if (from == kNone || to == kNone) return std::nullopt;
  const auto up = [&](std::uint32_t start) {
    std::vector<std::uint32_t> chain;
    for (std::uint32_t at = start; at != kNone; at = frames_[at].parent) chain.push_back(at);
    return chain;
  };
  Chains both{up(from), up(to)};
  if (both.of_fixed.back() != both.of_frame.back()) return std::nullopt;  // two trees
  while (!both.of_fixed.empty() && !both.of_frame.empty() && both.of_fixed.back() == both.of_frame.back()) {
    both.of_fixed.pop_back();
    both.of_frame.pop_back();
  }
  return both;
}

std::optional<std::int64_t> FrameTree::newest_common(std::string_view fixed, std::string_view frame) const {
  const std::optional<Chains> both = chains(fixed, frame);
  if (!both) return std::nullopt;
  std::int64_t newest = kAlways;
  for (const std::vector<std::uint32_t>* chain : {&both->of_fixed, &both->of_frame}) {
    for (const std::uint32_t link : *chain) newest = std::min(newest, frames_[link].instants.back().stamp_ns);
  }
  return newest;
}

std::optional<Pose> FrameTree::at(const KnownFrame& frame, std::int64_t stamp_ns) {
  const std::deque<StampedPose>& instants = frame.instants;
  if (instants.empty()) return std::nullopt;
  if (instants.back().stamp_ns == kAlways) return instants.back().X_PC;
  const auto after =
      std::lower_bound(instants.begin(), instants.end(), stamp_ns,
                       [](const StampedPose& other, std::int64_t time) { return other.stamp_ns < time; });
  if (after == instants.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->X_PC;
  if (after == instants.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  const double share =
      static_cast<double>(stamp_ns - before.stamp_ns) / static_cast<double>(after->stamp_ns - before.stamp_ns);
  return Pose{before.X_PC.position + share * (after->X_PC.position - before.X_PC.position),
              before.X_PC.rotation.slerp(share, after->X_PC.rotation)};
}

std::optional<Pose> FrameTree::along(const std::vector<std::uint32_t>& chain, std::int64_t stamp_ns) const {
  Pose X_AF;  // of the chain's first frame in the one above its last
  for (const std::uint32_t link : chain) {
    const std::optional<Pose> step = at(frames_[link], stamp_ns);
    if (!step) return std::nullopt;
    X_AF = product(*step, X_AF);
  }
  return X_AF;
}

std::optional<Pose> FrameTree::lookup(std::string_view fixed, std::string_view frame, std::int64_t stamp_ns) const {
  const std::optional<Chains> both = chains(fixed, frame);
  if (!both) return std::nullopt;
  const std::optional<Pose> of_fixed = along(both->of_fixed, stamp_ns);
  const std::optional<Pose> of_frame = along(both->of_frame, stamp_ns);
  if (!of_fixed || !of_frame) return std::nullopt;
  return product(inverse(*of_fixed), *of_frame);
}

}  // namespace collided::ros
