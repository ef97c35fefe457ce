#include "server/world/query/object_parts.hpp"

#include "server/world/objects/parts.hpp"

namespace collided::engine {
namespace {

/// Calls visit(scene, part) for the run of a static scene's triangles that the object is, if it is one.
template <class Visit>
void visit_scene_part(const Snapshot& snapshot, const ObjectInfo& info, const Visit& visit) {
  for (const auto& scene : snapshot.scenes) {
    const bool is_of_scene = info.scene_part < scene->parts.size() && scene->part_objects[info.scene_part] == info.id;
    if (is_of_scene) visit(*scene, scene->parts[info.scene_part]);
  }
}

}  // namespace

std::size_t part_count_of(const Snapshot& snapshot, ObjectId object) {
  const ObjectInfo& info = *snapshot.objects[slot_of(object)];
  std::size_t count = info.primitives.size() + (info.mesh ? info.mesh->mesh->triangles.size() : 0);
  visit_scene_part(snapshot, info, [&](const StaticScene&, const Part& part) { count += part.triangle_count; });
  return count;
}

std::vector<ConvexPart> parts_of_object(const Snapshot& snapshot, ObjectId object) {
  const ObjectInfo& info = *snapshot.objects[slot_of(object)];
  const Frame frame = snapshot.frame(slot_of(object));
  std::vector<ConvexPart> parts;
  for (const Primitive& primitive : info.primitives) {
    std::visit([&](const auto& own) { parts.emplace_back(Primitive(place(frame, own))); }, primitive);
  }
  for (std::uint32_t i = 0; info.mesh && i < info.mesh->mesh->triangles.size(); ++i) {
    parts.emplace_back(place(frame, info.mesh->mesh->triangle(i)));
  }
  visit_scene_part(snapshot, info, [&](const StaticScene& scene, const Part& part) {
    for (std::uint32_t i = 0; i < part.triangle_count; ++i)
      parts.emplace_back(scene.mesh.triangle(part.first_triangle + i));
  });
  return parts;
}

std::vector<GivenPart> given_parts_of_object(const Snapshot& snapshot, ObjectId object) {
  const ObjectInfo& info = *snapshot.objects[slot_of(object)];
  const Placed placed = placed_in(snapshot, slot_of(object));
  std::vector<GivenPart> parts;
  for (const Primitive& primitive : info.primitives) parts.push_back(placed.given(primitive));
  for (std::uint32_t i = 0; info.mesh && i < info.mesh->mesh->triangles.size(); ++i) parts.push_back(placed.given(i));
  visit_scene_part(snapshot, info,
                   [&](const StaticScene&, const Part& part) { parts.resize(parts.size() + part.triangle_count); });
  for (GivenPart& part : parts) part.frame = nullptr;  // the frame is temporary, the pose is not
  return parts;
}

}  // namespace collided::engine
