#include "client/view/page_messages.hpp"
#include "client/library/connection/described_status.hpp"
#include "client/view/json_text.hpp"
#include "idl/described_json.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

namespace collided::view {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "numbers go out as they lie in memory");

/// A part in the page's format: the number of its kind, then its numbers.
struct PartText {
  json operator()(const SphereShape& s) const { return text(0, s.center, s.radius_m); }
  json operator()(const BoxShape& s) const { return text(1, s.center, s.rotation, s.half_m); }
  json operator()(const CapsuleShape& s) const { return text(2, s.a, s.b, s.radius_m); }
  json operator()(const CylinderShape& s) const { return text(3, s.a, s.b, s.radius_m); }
  json operator()(const ConeShape& s) const { return text(4, s.apex, s.base, s.radius_m); }
  json operator()(const EllipsoidShape& s) const { return text(5, s.center, s.rotation, s.half_m); }
  json operator()(const HalfSpaceShape& s) const { return text(6, s.point, s.normal); }
  /// The other kinds come as runs of surfaces, or as several of the parts above.
  template <class Other>
  json operator()(const Other&) const {
    return nullptr;
  }

  template <class... Values>
  static json text(int kind, const Values&... values) {
    json part{kind};
    (append(part, values), ...);
    return part;
  }
};

json object_text(const ShownObject& object) {
  json pose = json::array();
  append(pose, object.pose.position);
  append(pose, object.pose.rotation);
  json parts = json::array();
  for (const ShapePart& part : object.parts) {
    json text = std::visit(PartText(), part);
    if (!text.is_null()) parts.push_back(std::move(text));
  }
  json runs = json::array();
  for (const SurfaceRun& run : object.runs) {
    if (run.surface) runs.push_back({std::to_string(run.surface->number), run.first_triangle, run.triangle_count});
  }
  return {{"slot", slot_of(object.id)},
          {"name", object.name},
          {"scene", object.scene},
          {"moving", object.moving},
          {"stale", object.stale},
          {"layers", object.layers},
          {"mask", object.mask},
          {"group", object.group},
          {"pose", pose},
          {"parts", parts},
          {"runs", runs}};
}

/// Appends numbers to a text, as bytes.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t byte_count) { bytes_.reserve(byte_count); }
  template <class T>
  void write(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  void write(const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) write(v[axis]);
  }
  void write_single(const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) write(static_cast<float>(v[axis]));
  }
  std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// The middle of the bounds of the finite points, rounded to whole metres.
template <class Points, class PointOf>
Vec3 middle(const Points& points, PointOf&& point_of) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  for (const auto& entry : points) {
    const Vec3& point = point_of(entry);
    if (!point.allFinite()) continue;
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Vec3 center = (low / 2 + high / 2).array().round();
  return center.allFinite() ? center : Vec3::Zero();
}

json event_text(const Event& event) {
  json text{{"what", name_of(event.kind)},
            {"a", event.a},
            {"b", event.b},
            {"a_slot", slot_of(event.a_id)},
            {"b_slot", slot_of(event.b_id)},
            {"time", seconds(event.world_time)},
            {"sequence", event.sequence},
            {"episode", event.episode}};
  if (event.kind == EventKind::ended) {
    text["why"] = name_of(event.reason);
    text["after"] = seconds(lasted(event));
  } else if (event.doubt == Doubt::none) {
    text["point"] = numbers(event.point);
    text["normal"] = numbers(event.normal);
    text["depth"] = number(event.depth_m);
    text["error"] = number(event.depth_error_m);
  }
  if (event.doubt != Doubt::none) text["doubt"] = name_of(event.doubt);
  if (event.contained != Containment::none) text["contained"] = event.contained == Containment::a_in_b ? "a" : "b";
  if (event.resync) text["resync"] = true;
  return text;
}

json list_of(std::span<const Event> events, std::size_t most, const char* type, const char* member) {
  const std::size_t left_out = events.size() > most ? events.size() - most : 0;
  json list = json::array();
  for (const Event& event : events.subspan(left_out)) list.push_back(event_text(event));
  return {{"type", type}, {member, list}, {"left_out", left_out}};
}

json recent_text(const Figures& recent) {
  const double over_s = std::max(1e-9, static_cast<double>(recent.up_ns) * 1e-9);
  const auto rate = [&](std::uint64_t count) { return static_cast<double>(count) / over_s; };
  const auto quantile = [](const std::vector<DurationStep>& durations, double part) {
    const std::optional<std::int64_t> ns = quantile_ns(durations, part);
    return ns ? json(static_cast<double>(*ns) * 1e-9) : json(nullptr);
  };
  json stages = json::array();
  for (const StageTime& stage : recent.stages)
    stages.push_back({{"stage", stage.stage}, {"share", static_cast<double>(stage.ns) * 1e-9 / over_s}});
  json asked = json::array();
  for (const AskedKind& kind : recent.questions) {
    asked.push_back({{"kind", kind.kind},
                     {"rate", rate(kind.answered)},
                     {"p50", quantile(kind.durations, 0.5)},
                     {"p99", quantile(kind.durations, 0.99)}});
  }
  return {{"stages", stages},
          {"asked", asked},
          {"steps", rate(recent.steps)},
          {"step_p50", quantile(recent.step_durations, 0.5)},
          {"step_p99", quantile(recent.step_durations, 0.99)},
          {"poses", rate(recent.poses.applied)},
          {"candidates",
           recent.steps > 0 ? static_cast<double>(recent.pairs.candidates) / static_cast<double>(recent.steps) : 0.0},
          {"filtered",
           recent.steps > 0 ? static_cast<double>(recent.pairs.filtered) / static_cast<double>(recent.steps) : 0.0}};
}

}  // namespace

std::string objects_text(const ShownObjects& shown) {
  json objects = json::array();
  for (const ShownObject& object : shown.objects) objects.push_back(object_text(object));
  return text_of({{"epoch", shown.epoch},
                  {"version", shown.version},
                  {"table_version", shown.table_version},
                  {"objects", objects}});
}

std::string surface_bytes(const Surface& surface) {
  constexpr std::size_t kHeader = 32;
  ByteWriter bytes(kHeader + 12 * (surface.vertices.size() + surface.triangles.size()));
  const Vec3 origin = middle(surface.vertices, [](const Vec3& vertex) -> const Vec3& { return vertex; });
  bytes.write(static_cast<std::uint32_t>(surface.vertices.size()));
  bytes.write(static_cast<std::uint32_t>(surface.triangles.size()));
  bytes.write(origin);
  for (const Vec3& vertex : surface.vertices) bytes.write_single(vertex - origin);
  for (const auto& corners : surface.triangles) {
    for (const std::uint32_t corner : corners) bytes.write(corner);
  }
  return std::move(bytes).take();
}

std::string poses_bytes(const Poses& poses) {
  constexpr std::size_t kHeader = 56;
  constexpr std::size_t kEach = 33;
  ByteWriter bytes(kHeader + kEach * poses.ids.size());
  const Vec3 origin = middle(poses.poses, [](const Pose& pose) -> const Vec3& { return pose.position; });
  bytes.write(std::uint32_t{1});
  bytes.write(static_cast<std::uint32_t>(poses.ids.size()));
  bytes.write(seconds(poses.world_time));
  bytes.write(static_cast<double>(poses.table_version));
  bytes.write(static_cast<double>(poses.version));
  bytes.write(origin);
  for (const Pose& pose : poses.poses) {
    bytes.write_single(pose.position - origin);
    for (const double part : {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()})
      bytes.write(static_cast<float>(part));
  }
  for (const std::uint64_t id : poses.ids) bytes.write(slot_of(id));
  for (const std::uint8_t stale : poses.stale) bytes.write(stale);
  return std::move(bytes).take();
}

std::string events_text(std::span<const Event> events, std::size_t most) {
  return text_of(list_of(events, most, "events", "events"));
}

std::string contacts_text(std::span<const Event> contacts, std::size_t most) {
  return text_of(list_of(contacts, most, "contacts", "contacts"));
}

std::string status_text(const ServerStatus& status, const std::optional<Figures>& recent) {
  json text = json_of(status);
  for (json& publisher : text["publishers"]) {
    publisher["messages"] = publisher["applied_sequence"];
    publisher.erase("applied_sequence");
  }
  for (const char* unused : {"poses_applied", "poses_dropped", "questions_refused", "last_event_sequence", "age"})
    text.erase(unused);
  text.update({{"type", "status"}, {"in_doubt", recent ? json(recent->pairs.in_doubt) : json(nullptr)}});
  if (recent) text["recent"] = recent_text(*recent);
  return text_of(text);
}

std::string standing_text(std::span<const draw::StandingOutline> outlines) {
  json list = json::array();
  for (const draw::StandingOutline& outline : outlines) list.push_back(json_of(outline));
  return text_of({{"type", "standing"}, {"standing", std::move(list)}});
}

std::string silent_text(double for_s) { return text_of({{"type", "silent"}, {"seconds", for_s}}); }

std::string table_text(const ShownObjects& shown) {
  return text_of({{"type", "table"}, {"epoch", shown.epoch}, {"table_version", shown.table_version}});
}

std::string hello_text(bool y_is_up, std::string_view connection) {
  return text_of(
      {{"type", "hello"}, {"version", library_version()}, {"up", y_is_up ? "y" : "z"}, {"connection", connection}});
}

}  // namespace collided::view
