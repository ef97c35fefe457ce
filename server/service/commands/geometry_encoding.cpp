#include "server/service/commands/geometry_encoding.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "idl/geometry_generated.h"
#include "server/exact_phase/edge_kinds.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/scene_file/scene_encoder.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/weld.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/world/frozen.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {
namespace {

static_assert(static_cast<int>(format::EdgeKinds::boundary) == kBoundaryEdge &&
              static_cast<int>(format::EdgeKinds::many) == kManyEdge &&
              static_cast<int>(format::EdgeKinds::crease) == kCreaseEdge &&
              static_cast<int>(format::EdgeKinds::material) == kMaterialEdge);

std::string text_of(const flatbuffers::FlatBufferBuilder& builder) {
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

void refuse_above_limit(std::uint64_t bytes, const std::string& what) {
  if (bytes <= kMaxGeometryBytes) return;
  throw BadCommand(
      fmt::format("{} take {} bytes to tell, allowed are {}; nothing was told", what, bytes, kMaxGeometryBytes),
      "name fewer of them");
}

const std::shared_ptr<const StaticScene>* scene_of(const Snapshot& state, const ObjectInfo& info) {
  for (const auto& scene : state.scenes) {
    if (scene->name == info.rare->scene) return &scene;
  }
  return nullptr;
}

/// Collects the objects of a state into one buffer, and refuses them beyond kMaxGeometryBytes.
class ObjectsEncoder {
 public:
  ObjectsEncoder(const Snapshot& state, SurfaceNumbers& numbers)
      : state_(state), numbers_(numbers), encoder_(64 * 1024) {}

  void add(const ObjectInfo& info) {
    bytes_ += 320 + info.name.size() + info.rare->scene.size() + 200 * info.primitives.size();
    refuse_above_limit(bytes_, fmt::format("{} objects and more", objects_.size() + 1));
    flatbuffers::FlatBufferBuilder& builder = encoder_.builder();
    const std::vector<format::Run> runs = runs_of(info);
    Shape solids;
    for (const Primitive& primitive : info.primitives) {
      if (!std::holds_alternative<Hull>(primitive)) solids.primitives.push_back(primitive);
    }
    const auto shape = solids.empty() ? 0 : encoder_.shape(solids);
    const auto name = builder.CreateString(info.name);
    const auto scene = builder.CreateString(info.rare->scene);
    const auto run_vector = builder.CreateVectorOfStructs(runs);
    const std::uint32_t slot = slot_of(info.id);
    // A scene's parts are in world coordinates already.
    const Pose pose = info.scene_part == kNoTriangle ? state_.poses[slot] : Pose{};
    const format::Filter filter = packed(info.filter);
    const format::Vec3 position = packed(pose.position);
    const format::Quat rotation = packed(pose.rotation);
    objects_.push_back(format::CreateShownObject(builder, info.id, name, scene, info.moving, state_.stale[slot] != 0,
                                                 &filter, &position, &rotation, shape, run_vector));
  }

  std::string finish() {
    flatbuffers::FlatBufferBuilder& builder = encoder_.builder();
    builder.Finish(format::CreateShownObjectsDirect(builder, state_.epoch, state_.version, state_.objects.version(),
                                                    state_.world_time_ns, &objects_));
    return text_of(builder);
  }

 private:
  /// The runs of triangles that show the object: its part of a scene, its mesh, or its hulls.
  std::vector<format::Run> runs_of(const ObjectInfo& info) {
    std::vector<format::Run> runs;
    const auto add_whole = [&](const std::shared_ptr<const TriangleMesh>& mesh, bool is_hull) {
      runs.emplace_back(numbers_.number_of(mesh), 0, static_cast<std::uint32_t>(mesh->triangles.size()), is_hull);
    };
    if (info.scene_part != kNoTriangle) {
      const std::shared_ptr<const StaticScene>* scene = scene_of(state_, info);
      if (scene == nullptr) return runs;
      const Part& part = (*scene)->parts[info.scene_part];
      runs.emplace_back(numbers_.number_of(*scene), part.first_triangle, part.triangle_count, false);
    }
    if (info.mesh) add_whole(info.mesh->mesh, false);
    for (const Primitive& primitive : info.primitives) {
      if (const auto* hull = std::get_if<Hull>(&primitive)) add_whole(hull->mesh, true);
    }
    return runs;
  }

  const Snapshot& state_;
  SurfaceNumbers& numbers_;
  SceneEncoder encoder_;
  std::uint64_t bytes_ = 0;
  std::vector<flatbuffers::Offset<format::ShownObject>> objects_;
};

/// The material of each triangle is the number of its part: parts come from a file's materials and groups.
std::vector<std::uint32_t> materials_of(const StaticScene& scene) {
  std::vector<std::uint32_t> materials(scene.mesh.triangles.size());
  for (std::uint32_t i = 0; i < scene.parts.size(); ++i) {
    std::fill_n(materials.begin() + scene.parts[i].first_triangle, scene.parts[i].triangle_count, i);
  }
  return materials;
}

struct Edges {
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint8_t> kinds;
};

/// The edges of a surface with their kinds, as geometry.fbs has them.
Edges edges_of(const SurfaceNumbers::Found& surface, double crease_cosine) {
  const TriangleMesh& mesh = *surface.mesh;
  std::vector<bool> is_flat(mesh.triangles.size());
  for (std::uint32_t i = 0; i < is_flat.size(); ++i) is_flat[i] = has_zero_area(mesh.triangle(i));
  const EdgeTable table = edge_table(mesh, first_equal_vertices(mesh.vertices), is_flat);
  const std::vector<std::uint32_t> materials =
      surface.scene ? materials_of(*surface.scene) : std::vector<std::uint32_t>{};
  Edges edges{.numbers = {},
              .kinds = edge_kinds(mesh, table, {.crease_cosine = crease_cosine, .material = materials, .eye = {}})};
  edges.numbers.reserve(4 * table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto uses = table.uses_of(i);
    const std::uint32_t second = uses.size() > 1 ? triangle_of(uses[1]) : kNoTriangle;
    for (const std::uint32_t number : {table.edges[i].low, table.edges[i].high, triangle_of(uses[0]), second}) {
      edges.numbers.push_back(number);
    }
    if (table.is_inconsistent(i)) edges.kinds[i] |= static_cast<std::uint8_t>(format::EdgeKinds::turned);
  }
  return edges;
}

}  // namespace

std::string encode_objects(const Snapshot& state, const std::function<bool(const ObjectInfo&)>& wanted,
                           SurfaceNumbers& numbers) {
  ObjectsEncoder encoder(state, numbers);
  for (const auto& info : state.objects) {
    if (info && wanted(*info)) encoder.add(*info);
  }
  return encoder.finish();
}

std::string encode_snapshot(const Snapshot& state) {
  std::uint64_t bytes = 0;
  for (const auto& scene : state.scenes) bytes += encoded_bytes(scene->mesh);
  refuse_above_limit(bytes, fmt::format("the triangles of {} scenes", state.scenes.size()));
  std::variant<Scene, Refusal> frozen = frozen_scene(state);
  if (const auto* refusal = std::get_if<Refusal>(&frozen)) throw BadCommand(refusal->reason);
  const Scene& scene = std::get<Scene>(frozen);
  bytes = encoded_bytes(scene);
  refuse_above_limit(bytes, fmt::format("{} parts and objects", scene.parts.size() + scene.objects.size()));
  SceneEncoder encoder(bytes);
  encoder.scene(scene);
  seal_scene(encoder.bytes());
  return text_of(encoder.builder());
}

std::string encode_surface(const SurfaceNumbers::Found& surface, std::optional<double> crease_cosine) {
  const TriangleMesh& mesh = *surface.mesh;
  // At most three edges a triangle, most of them shared by two; 17 bytes an edge.
  const std::uint64_t bytes = encoded_bytes(mesh) + (crease_cosine ? 17 * 3 * mesh.triangles.size() / 2 : 0);
  refuse_above_limit(bytes, fmt::format("a surface's {} triangles", mesh.triangles.size()));
  SceneEncoder encoder(bytes + 1024);
  const auto mesh_table = encoder.mesh(mesh);
  const Edges edges = crease_cosine ? edges_of(surface, *crease_cosine) : Edges{};
  flatbuffers::FlatBufferBuilder& builder = encoder.builder();
  builder.Finish(format::CreateSurfaceDirect(builder, mesh_table, crease_cosine ? &edges.numbers : nullptr,
                                             crease_cosine ? &edges.kinds : nullptr));
  return text_of(builder);
}

std::string encode_poses(const Snapshot& state) {
  std::vector<std::uint64_t> ids;
  for (const auto& info : state.objects) {
    if (info && info->moving) ids.push_back(info->id);
  }
  if (ids.size() > kMaxPosesReported) {
    throw BadCommand(fmt::format("{} objects move; the poses of {} at most are told", ids.size(), kMaxPosesReported));
  }
  std::vector<double> numbers;
  numbers.reserve(kPoseNumbers * ids.size());
  std::vector<std::uint8_t> stale;
  stale.reserve(ids.size());
  for (const std::uint64_t id : ids) {
    const Pose& pose = state.poses[slot_of(id)];
    const Vec3& p = pose.position;
    const Quat& q = pose.rotation;
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    stale.push_back(state.stale[slot_of(id)]);
  }
  flatbuffers::FlatBufferBuilder builder(256 + 80 * ids.size());
  builder.Finish(format::CreatePosesDirect(builder, state.epoch, state.version, state.objects.version(),
                                           state.world_time_ns, &ids, &numbers, &stale));
  return text_of(builder);
}

std::string encode_page(std::uint64_t transfer, std::uint64_t total, std::uint64_t first, std::string_view bytes) {
  flatbuffers::FlatBufferBuilder builder(bytes.size() + 128);
  const auto vector = builder.CreateVector(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  builder.Finish(format::CreatePage(builder, transfer, total, first, vector));
  return text_of(builder);
}

}  // namespace collided::engine::service
