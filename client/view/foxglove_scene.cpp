#include "client/view/foxglove_scene.hpp"
#include "client/view/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include <nlohmann/json.hpp>

namespace collided::view {
namespace {

using nlohmann::json;

/// Colours of static, moving and touching objects.
const json kStill{{"r", 0.78}, {"g", 0.77}, {"b", 0.74}, {"a", 1}};
const json kMoving{{"r", 0.36}, {"g", 0.36}, {"b", 0.35}, {"a", 1}};
const json kAccent{{"r", 0.78}, {"g", 0.27}, {"b", 0.05}, {"a", 1}};
constexpr const char* kWorld = "world";

json time(std::chrono::nanoseconds since_1970) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(0, since_1970.count());
  return {{"sec", ns / kSecond_ns}, {"nsec", ns % kSecond_ns}};
}

json vector(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

json quaternion(const Quat& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

json pose(const Vec3& position, const Quat& rotation) {
  return {{"position", vector(position)}, {"orientation", quaternion(rotation)}};
}

/// The primitives of one object, in its own frame.
struct SceneEntity {
  const json& color;
  json cubes = json::array();
  json spheres = json::array();
  json cylinders = json::array();
  json triangles = json::array();

  void ball(const Vec3& center, const Quat& rotation, const Vec3& half) {
    spheres.push_back({{"pose", pose(center, rotation)}, {"size", vector(2 * half)}, {"color", color}});
  }
  void box(const Vec3& center, const Quat& rotation, const Vec3& half) {
    cubes.push_back({{"pose", pose(center, rotation)}, {"size", vector(2 * half)}, {"color", color}});
  }
  /// Adds a cylinder or cone with its axis from `bottom` to `top`.
  void tube(const Vec3& bottom, const Vec3& top, double radius_m, double top_scale) {
    const Vec3 along = top - bottom;
    const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), along);
    cylinders.push_back({{"pose", pose((bottom + top) / 2, turn)},
                         {"size", vector({2 * radius_m, 2 * radius_m, along.norm()})},
                         {"bottom_scale", 1},
                         {"top_scale", top_scale},
                         {"color", color}});
  }

  void operator()(const SphereShape& s) { ball(s.center, Quat::Identity(), Vec3::Constant(s.radius_m)); }
  void operator()(const EllipsoidShape& s) { ball(s.center, s.rotation, s.half_m); }
  void operator()(const BoxShape& s) { box(s.center, s.rotation, s.half_m); }
  void operator()(const CylinderShape& s) { tube(s.a, s.b, s.radius_m, 1); }
  void operator()(const ConeShape& s) { tube(s.base, s.apex, s.radius_m, 0); }
  void operator()(const CapsuleShape& s) {
    if (s.a != s.b) tube(s.a, s.b, s.radius_m, 1);
    for (const Vec3& end : {s.a, s.b}) ball(end, Quat::Identity(), Vec3::Constant(s.radius_m));
  }
  /// Half-spaces are unbounded and left out; the other kinds are runs of surfaces.
  template <class Other>
  void operator()(const Other&) {}

  static auto corners(const SurfaceRun& run) {
    return std::span(run.surface->triangles).subspan(run.first_triangle, run.triangle_count);
  }

  void run(const SurfaceRun& run) {
    const Surface& surface = *run.surface;
    std::unordered_map<std::uint32_t, std::size_t> known;  // vertex of the surface: its place among the points
    json points = json::array();
    json indices = json::array();
    for (const auto& triangle : corners(run)) {
      for (const std::uint32_t vertex : triangle) {
        const auto [place, is_new] = known.try_emplace(vertex, points.size());
        if (is_new) points.push_back(vector(surface.vertices[vertex]));
        indices.push_back(place->second);
      }
    }
    triangles.push_back({{"pose", pose(Vec3::Zero(), Quat::Identity())},
                         {"points", std::move(points)},
                         {"color", color},
                         {"colors", json::array()},
                         {"indices", std::move(indices)}});
  }

  /// The bounding box of a run.
  void bounds(const SurfaceRun& run) {
    Eigen::AlignedBox3d all;
    for (const auto& triangle : corners(run)) {
      for (const std::uint32_t vertex : triangle) all.extend(run.surface->vertices[vertex]);
    }
    box(all.center(), Quat::Identity(), all.sizes() / 2);
  }
};

/// left  number of triangles that the scene may still have; those of the object are subtracted
json entity_json(const ShownObject& object, std::chrono::nanoseconds now, const TriangleLimits& most,
                 std::uint32_t& left) {
  SceneEntity entity{.color = object.moving ? kMoving : kStill};
  for (const ShapePart& part : object.parts) std::visit(entity, part);
  for (const SurfaceRun& run : object.runs) {
    if (!run.surface || run.triangle_count == 0) continue;
    if (run.triangle_count > std::min(most.of_object, left)) {
      entity.bounds(run);
    } else {
      left -= run.triangle_count;
      entity.run(run);
    }
  }
  json result{{"timestamp", time(now)},
              {"frame_id", object.moving ? object.name : std::string(kWorld)},
              {"id", object.name},
              {"lifetime", {{"sec", 0}, {"nsec", 0}}},
              {"frame_locked", true},
              {"metadata", json::array()},
              {"arrows", json::array()},
              {"cubes", std::move(entity.cubes)},
              {"spheres", std::move(entity.spheres)},
              {"cylinders", std::move(entity.cylinders)},
              {"lines", json::array()},
              {"triangles", std::move(entity.triangles)},
              {"texts", json::array()},
              {"models", json::array()}};
  if (!object.moving) {
    // An object that does not move has no frame; its pose goes into each primitive.
    for (const char* kind : {"cubes", "spheres", "cylinders", "triangles"}) {
      for (json& primitive : result[kind]) {
        const json& own = primitive["pose"];
        const auto part = [&](const char* of, const char* axis) { return own[of][axis].get<double>(); };
        const Vec3 position(part("position", "x"), part("position", "y"), part("position", "z"));
        const Quat turn(part("orientation", "w"), part("orientation", "x"), part("orientation", "y"),
                        part("orientation", "z"));
        primitive["pose"] = pose(object.pose.position + object.pose.rotation * position, object.pose.rotation * turn);
      }
    }
  }
  return result;
}

}  // namespace

// The schemas have only the fields that are sent; programs know the types by name.
const FoxgloveSchema kSceneUpdateSchema{"foxglove.SceneUpdate",
                                        R"({"title":"foxglove.SceneUpdate","type":"object","properties":{
"deletions":{"type":"array","items":{"type":"object","properties":{
 "timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"type":{"type":"integer"},"id":{"type":"string"}}}},
"entities":{"type":"array","items":{"type":"object","properties":{
 "timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
 "frame_id":{"type":"string"},"id":{"type":"string"},"lifetime":{"type":"object","title":"duration","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
 "frame_locked":{"type":"boolean"},"metadata":{"type":"array","items":{"type":"object"}},"arrows":{"type":"array","items":{"type":"object"}},
 "cubes":{"type":"array","items":{"type":"object"}},"spheres":{"type":"array","items":{"type":"object"}},"cylinders":{"type":"array","items":{"type":"object"}},
 "lines":{"type":"array","items":{"type":"object"}},"triangles":{"type":"array","items":{"type":"object"}},"texts":{"type":"array","items":{"type":"object"}},
 "models":{"type":"array","items":{"type":"object"}}}}}}})"};
const FoxgloveSchema kFrameTransformsSchema{"foxglove.FrameTransforms",
                                            R"({"title":"foxglove.FrameTransforms","type":"object","properties":{
"transforms":{"type":"array","items":{"type":"object","properties":{
 "timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
 "parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},
 "translation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},
 "rotation":{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}}}}}})"};
const FoxgloveSchema kEventSchema{"collided.Event", R"({"title":"collided.Event","type":"object","properties":{
"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},
"what":{"type":"string"},"a":{"type":"string"},"b":{"type":"string"},"depth":{"type":"number"},"sequence":{"type":"integer"},"episode":{"type":"integer"}}})"};

std::string scene_update(const ShownObjects& shown, const TriangleLimits& most) {
  constexpr int kDeleteAll = 1;
  json entities = json::array();
  std::uint32_t left = most.of_scene;
  for (const ShownObject& object : shown.objects) entities.push_back(entity_json(object, shown.world_time, most, left));
  return text_of({{"deletions", {{{"timestamp", time(shown.world_time)}, {"type", kDeleteAll}, {"id", ""}}}},
                  {"entities", entities}});
}

std::string frame_transforms(const Poses& poses, const std::map<std::uint64_t, std::string>& names) {
  json transforms = json::array();
  for (std::size_t i = 0; i < poses.ids.size(); ++i) {
    const auto name = names.find(poses.ids[i]);
    if (name == names.end()) continue;
    transforms.push_back({{"timestamp", time(poses.world_time)},
                          {"parent_frame_id", kWorld},
                          {"child_frame_id", name->second},
                          {"translation", vector(poses.poses[i].position)},
                          {"rotation", quaternion(poses.poses[i].rotation)}});
  }
  return text_of({{"transforms", transforms}});
}

std::string contact_update(std::span<const Event> events) {
  json entities = json::array();
  for (const Event& event : events) {
    if (event.kind != EventKind::began || event.doubt != Doubt::none || !event.point.allFinite()) continue;
    const Quat turn = Quat::FromTwoVectors(Vec3::UnitX(), event.normal);
    const json arrow{{"pose", pose(event.point, turn)}, {"shaft_length", 0.2},
                     {"shaft_diameter", 0.02},          {"head_length", 0.08},
                     {"head_diameter", 0.06},           {"color", kAccent}};
    entities.push_back({{"timestamp", time(event.world_time)},
                        {"frame_id", kWorld},
                        {"id", event.a + " x " + event.b},
                        {"lifetime", {{"sec", 1}, {"nsec", 0}}},
                        {"frame_locked", false},
                        {"arrows", {arrow}}});
    for (const char* none : {"metadata", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"})
      entities.back()[none] = json::array();
  }
  return entities.empty() ? std::string() : text_of({{"deletions", json::array()}, {"entities", entities}});
}

std::string standing_update(std::span<const draw::StandingOutline> outlines, const std::map<std::string, Pose>& still,
                            std::chrono::nanoseconds world_time) {
  constexpr int kDeleteAll = 1;
  constexpr int kLineStrip = 0;
  json entities = json::array();
  for (const draw::StandingOutline& outline : outlines) {
    const auto carrier = still.find(outline.carrier());
    const bool is_in_world = outline.carrier().empty() || carrier != still.end();
    json lines = json::array();
    for (const std::vector<Vec3>& points :
         draw::placed_lines(outline, carrier == still.end() ? Pose{} : carrier->second)) {
      json line = json::array();
      for (const Vec3& point : points) line.push_back(vector(point));
      lines.push_back({{"type", kLineStrip},
                       {"pose", pose(Vec3::Zero(), Quat::Identity())},
                       {"thickness", outline.is_held() ? 3 : 1.5},
                       {"scale_invariant", true},
                       {"points", std::move(line)},
                       {"color", outline.is_held() ? kAccent : kMoving},
                       {"colors", json::array()},
                       {"indices", json::array()}});
    }
    json texts = json::array();
    if (outline.distance_m && !outline.lines.empty()) {
      const std::vector<Vec3> line = draw::placed_lines(outline, {}).front();
      const Vec3 middle = 0.5 * (line.front() + line.back());
      texts.push_back({{"pose", pose(middle, Quat::Identity())},
                       {"billboard", true},
                       {"font_size", 14},
                       {"scale_invariant", true},
                       {"color", kAccent},
                       {"text", fmt::format("{} {:.4g} m", outline.name, *outline.distance_m)}});
    }
    std::string id = outline.name;
    if (outline.form == StandingForm::bands) id += " " + outline.about + " " + json(outline.band_m).dump();
    entities.push_back({{"timestamp", time(world_time)},
                        {"frame_id", is_in_world ? std::string(kWorld) : outline.carrier()},
                        {"id", id},
                        {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                        {"frame_locked", true},
                        {"lines", std::move(lines)},
                        {"texts", std::move(texts)}});
    for (const char* none : {"metadata", "arrows", "cubes", "spheres", "cylinders", "triangles", "models"})
      entities.back()[none] = json::array();
  }
  return text_of(
      {{"deletions", {{{"timestamp", time(world_time)}, {"type", kDeleteAll}, {"id", ""}}}}, {"entities", entities}});
}

std::string event_json(const Event& event) {
  return text_of({{"timestamp", time(event.world_time)},
                  {"what", name_of(event.kind)},
                  {"a", event.a},
                  {"b", event.b},
                  {"depth", std::isfinite(event.depth_m) ? json(event.depth_m) : json(nullptr)},
                  {"sequence", event.sequence},
                  {"episode", event.episode}});
}

}  // namespace collided::view
