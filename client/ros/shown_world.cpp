#include "client/ros/shown_world.hpp"

#include <limits>

#include "client/ros/marker_shape.hpp"

namespace collided::ros {
namespace {

constexpr std::chrono::milliseconds kPeriod{100};
/// Largest surface that is shown, in triangles; a larger one is left out, since messages are bounded.
constexpr std::uint32_t kMostTriangles = 20'000;

/// The markers of one object, one for each part; a capsule is a cylinder and two balls; cones and unbounded parts are
/// left out.
class ObjectMarkers {
 public:
  ObjectMarkers(const ShownObject& object, std::vector<ShownMarker>& markers) : object_(object), markers_(markers) {}

  void operator()(const SphereShape& s) { add(kSphere, s.center, Quat::Identity(), Vec3::Constant(2 * s.radius_m)); }
  void operator()(const EllipsoidShape& s) { add(kSphere, s.center, s.rotation, 2 * s.half_m); }
  void operator()(const BoxShape& s) { add(kCube, s.center, s.rotation, 2 * s.half_m); }
  void operator()(const CylinderShape& s) { tube(s.a, s.b, s.radius_m); }
  void operator()(const CapsuleShape& s) {
    if (s.a != s.b) tube(s.a, s.b, s.radius_m);
    for (const Vec3& end : {s.a, s.b}) add(kSphere, end, Quat::Identity(), Vec3::Constant(2 * s.radius_m));
  }
  template <class Other>
  void operator()(const Other&) {}

  void run(const SurfaceRun& run) {
    if (!run.surface || run.triangle_count == 0 || run.triangle_count > kMostTriangles) return;
    MarkerMessage& marker = add(kTriangleList, Vec3::Zero(), Quat::Identity(), Vec3::Ones());
    for (std::uint32_t i = 0; i < run.triangle_count; ++i) {
      for (const std::uint32_t corner : run.surface->triangles[run.first_triangle + i])
        marker.points.push_back(run.surface->vertices[corner]);
    }
  }

 private:
  MarkerMessage& add(std::int32_t type, const Vec3& center, const Quat& turn, const Vec3& scale) {
    ShownMarker& shown = markers_.emplace_back();
    if (object_.moving) shown.red = 0.2F, shown.green = 0.5F, shown.blue = 0.9F;
    shown.marker.name_space = object_.name;
    shown.marker.number = number_++;
    shown.marker.type = type;
    shown.marker.scale = scale;
    shown.marker.pose = {object_.pose.position + object_.pose.rotation * center,
                         (object_.pose.rotation * turn).normalized()};
    return shown.marker;
  }
  void tube(const Vec3& a, const Vec3& b, double radius_m) {
    const Vec3 along = b - a;
    add(kCylinder, (a + b) / 2, Quat::FromTwoVectors(Vec3::UnitZ(), along), {2 * radius_m, 2 * radius_m, along.norm()});
  }

  const ShownObject& object_;
  std::vector<ShownMarker>& markers_;
  std::int32_t number_ = 0;
};

}  // namespace

void ShownWorld::go_on(RosLink& link, const FrameTree& frames, std::int64_t now_ns) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + kPeriod;
  if (options_.shows_objects) show_objects(link, now_ns);
  if (options_.sends_tf) send_poses(link, frames, now_ns);
  if (!options_.clearance_of.empty()) tell_clearance(link);
}

void ShownWorld::show_objects(RosLink& link, std::int64_t now_ns) {
  Result<ShownObjects> objects = client_.shapes({}, &shown_);
  if (!objects || objects->version == shown_version_) return;
  shown_ = std::move(*objects);
  std::vector<ShownMarker> markers;
  for (const ShownObject& object : shown_.objects) {
    ObjectMarkers parts(object, markers);
    for (const ShapePart& part : object.parts) std::visit(parts, part);
    for (const SurfaceRun& run : object.runs) parts.run(run);
  }
  if (link.show(markers, options_.fixed, now_ns)) shown_version_ = shown_.version;
}

/// A known frame already has a broadcaster; two would contradict each other.
void ShownWorld::send_poses(RosLink& link, const FrameTree& frames, std::int64_t now_ns) {
  const Result<ShownObjects> objects = client_.shapes({.moving = true}, &shown_);
  if (!objects) return;
  std::vector<RosTransform> transforms;
  for (const ShownObject& object : objects->objects) {
    const std::string last = object.name.substr(object.name.rfind('/') + 1);
    if (!object.moving || frames.has(object.name) || frames.has(last)) continue;
    sent_.insert(object.name);
    transforms.push_back({options_.fixed, object.name, now_ns, object.pose, false});
  }
  if (!transforms.empty()) static_cast<void>(link.send(transforms));
}

void ShownWorld::tell_clearance(RosLink& link) {
  Result<ClearanceAnswer> answer = client_.clearance(options_.clearance_of, {.timeout = std::chrono::seconds(2)});
  clearance_error_ = answer ? std::string() : answer.error().message;
  clearance_.reset();
  // An unknown clearance is not a number.
  double clearance_m = std::numeric_limits<double>::quiet_NaN();
  if (answer) {
    const bool is_known = answer->verdict != Verdict::undecided;
    if (is_known && !answer->pairs.empty()) clearance_m = answer->pairs.front().clearance_m;
    if (is_known && answer->pairs.empty()) clearance_m = std::numeric_limits<double>::infinity();
    clearance_.emplace(std::move(*answer));
  }
  static_cast<void>(link.tell_clearance(clearance_m));
}

RosDiagnostic ShownWorld::clearance_diagnostic() const {
  RosDiagnostic told{
      .name = "collided: clearance of " + options_.clearance_of, .message = "known", .level = 0, .values = {}};
  if (!clearance_) {
    told.level = 2;
    told.message = clearance_error_.empty() ? "not asked yet" : clearance_error_;
    return told;
  }
  if (clearance_->verdict == Verdict::hit) told.message = "touching";
  if (clearance_->verdict == Verdict::undecided) {
    told.level = 1;
    told.message = clearance_->uncovered ? "undecided: it reaches into unknown space" : "undecided";
  }
  if (!clearance_->pairs.empty()) {
    told.values.emplace_back("a", clearance_->pairs.front().a);
    told.values.emplace_back("b", clearance_->pairs.front().b);
    told.values.emplace_back("clearance_m", std::to_string(clearance_->pairs.front().clearance_m));
  }
  return told;
}

}  // namespace collided::ros
