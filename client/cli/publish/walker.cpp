#include "client/cli/publish/walker.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "client/cli/session.hpp"

namespace collided::cli {
namespace {

constexpr std::array<std::string_view, 4> kFootJoints{"LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase"};

bool is_foot(const std::string& joint) {
  return std::find(kFootJoints.begin(), kFootJoints.end(), joint) != kFootJoints.end();
}

Shape part_shape(const MotionCapture& bvh, std::size_t joint, const WalkerOptions& options) {
  if (is_foot(bvh.joints[joint].name)) return {SphereShape{.radius_m = options.foot_radius_m}};
  Shape shape;
  for (const CapturedJoint& child : bvh.joints) {
    const Vec3 end = child.offset * options.unit_m;
    const bool is_bone = child.parent == static_cast<int>(joint) && end != Vec3::Zero();
    if (is_bone) shape.push_back(CapsuleShape{.b = end, .radius_m = options.bone_radius_m});
  }
  if (shape.empty()) shape.push_back(SphereShape{.radius_m = options.bone_radius_m});
  return shape;
}

/// A group number made from a name by the hash FNV-1a; never 0.
std::uint32_t group_of(const std::string& name) {
  std::uint32_t hash = 2166136261U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  return hash == 0 ? 1 : hash;
}

class Walker : public MotionSource {
 public:
  Walker(MotionCapture bvh, const WalkerOptions& options)
      : bvh_(std::move(bvh)), options_(options), parts_(walker_parts(bvh_, options)) {
    if (bvh_.frame_count < 2) throw bad_use("the recording has no frame after its first, artificial one");
    std::set<std::string> names;
    for (const WalkerPart& part : parts_) {
      if (!names.insert(part.name).second) throw bad_use(fmt::format("two joints are called '{}'", part.name));
    }
  }

  void begin(Session&, const Globals&, WorldPublisher& publisher) override {
    const std::vector<Pose> poses = walker_poses(bvh_, parts_, options_, 1);
    for (std::size_t at = 0; at < parts_.size(); ++at) {
      ObjectOptions object;
      object.name = parts_[at].name;
      object.shape = parts_[at].shape;
      object.pose = poses[at];
      object.layers = options_.objects.layers;
      object.mask = options_.objects.mask;
      object.lost_policy = options_.objects.lost_policy;
      object.group = options_.group != 0 ? options_.group : group_of(options_.name);
      objects_.push_back(take(publisher.add(object)));
    }
  }

  std::optional<double> next_time() override {
    if (frame_ >= bvh_.frame_count) return std::nullopt;
    return static_cast<double>(frame_ - 1) * bvh_.frame_seconds;
  }

  std::size_t move(WorldPublisher& publisher) override {
    const std::vector<Pose> poses = walker_poses(bvh_, parts_, options_, frame_++);
    // When the recording restarts, the person is placed at the start, not moved there through the room.
    for (std::size_t at = 0; at < poses.size(); ++at) moved(publisher.move(objects_[at], poses[at], restarted_));
    restarted_ = false;
    return poses.size();
  }

  bool restart() override {
    frame_ = 1;
    restarted_ = true;
    return true;
  }

  void report(Record& record, std::vector<std::string>& lines) const override {
    record.push_back({"objects", std::uint64_t{parts_.size()}});
    lines.push_back(fmt::format("  {} parts of '{}'", parts_.size(), printable(options_.name)));
  }

 private:
  MotionCapture bvh_;
  WalkerOptions options_;
  std::vector<WalkerPart> parts_;
  std::vector<Publisher::Object> objects_;
  std::size_t frame_ = 1;
  bool restarted_ = false;
};

}  // namespace

std::vector<WalkerPart> walker_parts(const MotionCapture& bvh, const WalkerOptions& options) {
  std::vector<WalkerPart> parts;
  for (std::size_t joint = 0; joint < bvh.joints.size(); ++joint) {
    const CapturedJoint& definition = bvh.joints[joint];
    if (!definition.is_end())
      parts.push_back({options.name + "/" + definition.name, joint, part_shape(bvh, joint, options)});
  }
  return parts;
}

std::vector<Pose> walker_poses(const MotionCapture& bvh, const std::vector<WalkerPart>& parts,
                               const WalkerOptions& options, std::size_t frame) {
  const std::vector<Pose> joints = joint_poses(bvh, frame);
  // A quarter turn about x, with exact zeros for positions and the nearest unit quaternion for rotations.
  const double half = std::sqrt(0.5);
  const Quat to_z_up = options.up == 'z' ? Quat(half, half, 0, 0) : Quat::Identity();
  std::vector<Pose> poses;
  poses.reserve(parts.size());
  for (const WalkerPart& part : parts) {
    const Vec3 p = joints[part.joint].position * options.unit_m;
    const Vec3 position = options.up == 'z' ? Vec3(p.x(), -p.z(), p.y()) : p;
    poses.push_back({position, (to_z_up * joints[part.joint].rotation).normalized()});
  }
  return poses;
}

std::unique_ptr<MotionSource> make_walker(MotionCapture bvh, const WalkerOptions& options) {
  return std::make_unique<Walker>(std::move(bvh), options);
}

}  // namespace collided::cli
