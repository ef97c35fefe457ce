#include "client/cli/publish/motion_capture.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr std::size_t kMostJoints = 4'096;
constexpr std::size_t kMostLevels = 64;

/// The words of a text, one after the other, with their lines.
class Words {
 public:
  Words(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::string_view next(std::string_view expected) {
    const std::string_view word = next_or_nothing();
    if (word.empty()) fail(fmt::format("the file ends where {} should stand", expected));
    return word;
  }

  void want(std::string_view literal) {
    const std::string_view word = next(fmt::format("'{}'", literal));
    if (word != literal) fail(fmt::format("'{}' where '{}' should stand", shown(word), literal));
  }

  double number(std::string_view meaning) {
    const std::string_view word = next(meaning);
    try {
      return parse_finite(word);
    } catch (const Failure&) { fail(fmt::format("'{}' where {} should stand", shown(word), meaning)); }
  }

  std::size_t count(std::string_view meaning, std::size_t most) {
    const std::string_view word = next(meaning);
    std::uint64_t value = 0;
    try {
      value = parse_count(word);
    } catch (const Failure&) { fail(fmt::format("'{}' where {} should stand", shown(word), meaning)); }
    if (value > most) fail(fmt::format("{} {}, allowed {}", word, meaning, most));
    return static_cast<std::size_t>(value);
  }

  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }

  std::size_t bytes_left() const { return text_.size() - at_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw bad_use(fmt::format("{} line {}: {}", name_, line_, what));
  }

  static std::string shown(std::string_view word) { return printable(word.substr(0, 40)); }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
  }

  std::string_view next_or_nothing() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

BvhChannel channel_by_name(Words& words) {
  constexpr std::array<std::string_view, 6> kNames{"Xposition", "Yposition", "Zposition",
                                                   "Xrotation", "Yrotation", "Zrotation"};
  const std::string_view word = words.next("a channel");
  for (std::size_t at = 0; at < kNames.size(); ++at) {
    if (kNames[at] == word) return static_cast<BvhChannel>(at);
  }
  words.fail(fmt::format("'{}' is no channel; channels: Xposition Yposition Zposition Xrotation Yrotation Zrotation",
                         Words::shown(word)));
}

void read_channels(Words& words, MotionCapture& bvh, CapturedJoint& joint) {
  const std::size_t count = words.count("channels of one joint", 6);
  joint.first_channel = bvh.channel_count;
  for (std::size_t at = 0; at < count; ++at) joint.channels.push_back(channel_by_name(words));
  bvh.channel_count += count;
}

std::size_t add_joint(Words& words, MotionCapture& bvh, std::string_view name, int parent) {
  if (bvh.joints.size() >= kMostJoints) words.fail(fmt::format("more than {} joints", kMostJoints));
  CapturedJoint joint;
  joint.name = std::string(name);
  joint.parent = parent;
  words.want("{");
  bvh.joints.push_back(std::move(joint));
  return bvh.joints.size() - 1;
}

/// Reads the tree of joints, without recursion, so that a hostile depth cannot exhaust the stack.
void read_hierarchy(Words& words, MotionCapture& bvh) {
  words.want("HIERARCHY");
  words.want("ROOT");
  const std::string_view root_name = words.next("the root's name");
  std::vector<std::size_t> open{add_joint(words, bvh, root_name, -1)};
  while (!open.empty()) {
    const std::string_view word = words.next("OFFSET, CHANNELS, JOINT, End or '}'");
    const std::size_t current = open.back();
    if (word == "}") {
      open.pop_back();
    } else if (word == "OFFSET") {
      for (int axis = 0; axis < 3; ++axis) bvh.joints[current].offset[axis] = words.number("a number of OFFSET");
    } else if (word == "CHANNELS") {
      if (bvh.joints[current].is_end() || !bvh.joints[current].channels.empty())
        words.fail("CHANNELS stands twice, or in an End Site");
      read_channels(words, bvh, bvh.joints[current]);
    } else if (word == "JOINT" || word == "End") {
      if (bvh.joints[current].is_end()) words.fail("an End Site has no joints");
      if (open.size() >= kMostLevels) words.fail(fmt::format("joints nest deeper than {}", kMostLevels));
      const std::string_view name = words.next("a joint's name");
      open.push_back(add_joint(words, bvh, word == "End" ? std::string_view{} : name, static_cast<int>(current)));
    } else {
      words.fail(fmt::format("'{}' where OFFSET, CHANNELS, JOINT, End or '}}' should stand", Words::shown(word)));
    }
  }
  if (bvh.channel_count == 0) words.fail("no joint has a channel: nothing moves");
}

void read_motion(Words& words, MotionCapture& bvh) {
  words.want("MOTION");
  words.want("Frames:");
  // Every value takes at least a digit and a blank, so the rest of the text bounds what may be reserved.
  const std::size_t most_frames = words.bytes_left() / (2 * bvh.channel_count) + 1;
  bvh.frame_count = words.count("frames", most_frames);
  words.want("Frame");
  words.want("Time:");
  bvh.frame_seconds = words.number("the time of a frame");
  if (!(bvh.frame_seconds > 0))
    words.fail(fmt::format("frame time {} must be above 0", format_number(bvh.frame_seconds)));
  bvh.values.reserve(bvh.frame_count * bvh.channel_count);
  for (std::size_t at = 0; at < bvh.frame_count * bvh.channel_count; ++at)
    bvh.values.push_back(words.number("a channel's value"));
  if (!words.at_end())
    words.fail(fmt::format("more values than {} frames of {} channels take", bvh.frame_count, bvh.channel_count));
}

Quat rotation_about(BvhChannel channel, double degrees) {
  const double angle = degrees * (std::numbers::pi / 180);
  switch (channel) {
    case BvhChannel::x_rotation: return Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    case BvhChannel::y_rotation: return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    default: return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
  }
}

}  // namespace

MotionCapture parse_bvh(std::string_view text, const std::string& name) {
  MotionCapture bvh;
  Words words(text, name);
  read_hierarchy(words, bvh);
  read_motion(words, bvh);
  return bvh;
}

MotionCapture read_bvh(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw bad_use(fmt::format("{}: cannot open that file", path));
  const auto size = static_cast<std::streamoff>(file.tellg());
  if (size < 0 || static_cast<std::size_t>(size) > kMostBytes)
    throw bad_use(fmt::format("{}: {} bytes, allowed {}", path, static_cast<long long>(size), kMostBytes));
  std::string text(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  file.read(text.data(), size);
  if (!file) throw bad_use(fmt::format("{}: could not be read to its end", path));
  return parse_bvh(text, path);
}

std::vector<Pose> joint_poses(const MotionCapture& bvh, std::size_t frame) {
  const double* values = bvh.values.data() + frame * bvh.channel_count;
  std::vector<Pose> poses(bvh.joints.size());
  for (std::size_t at = 0; at < bvh.joints.size(); ++at) {
    const CapturedJoint& joint = bvh.joints[at];
    Vec3 translation = joint.offset;
    Quat rotation = Quat::Identity();
    for (std::size_t channel = 0; channel < joint.channels.size(); ++channel) {
      const double value = values[joint.first_channel + channel];
      const BvhChannel kind = joint.channels[channel];
      if (kind <= BvhChannel::z_position) translation[static_cast<int>(kind)] += value;
      else rotation = rotation * rotation_about(kind, value);
    }
    if (joint.parent < 0) {
      poses[at] = {translation, rotation};
      continue;
    }
    const Pose& parent = poses[static_cast<std::size_t>(joint.parent)];
    poses[at] = {parent.position + parent.rotation * translation, (parent.rotation * rotation).normalized()};
  }
  return poses;
}

}  // namespace collided::cli
