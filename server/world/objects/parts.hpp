#pragma once

#include <variant>

#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// The object at its pose in this state.
inline Placed placed_in(const Snapshot& snapshot, std::uint32_t slot) {
  return {.info = snapshot.objects[slot].get(),
          .frame = snapshot.frame(slot),
          .bounds = snapshot.bounds(slot),
          .pose = snapshot.has_given_poses ? &snapshot.poses[slot] : nullptr};
}

/// Calls visit(object, triangle, shape, given) for every part of every object, in world coordinates, without an index:
/// shape is a primitive or a Triangle; triangle is its number within the object, or kNoTriangle for a primitive; given
/// is the part before it was placed.
template <class Visit>
void visit_parts(const Snapshot& snapshot, Visit&& visit) {
  for (const auto& scene : snapshot.scenes) {
    for (std::uint32_t i = 0; i < scene->mesh.triangles.size(); ++i) {
      const std::uint32_t part = scene->part_of(i);
      const ObjectId object = scene->part_objects[part];
      if (!snapshot.objects[slot_of(object)]) continue;
      visit(object, i - scene->parts[part].first_triangle, scene->mesh.triangle(i), GivenPart{});
    }
  }
  for (const auto& info : snapshot.objects) {
    if (!info) continue;
    const Placed object = placed_in(snapshot, slot_of(info->id));
    const auto visit_primitive = [&](const Primitive& primitive) {
      const GivenPart given = object.given(primitive);
      std::visit([&](const auto& own) { visit(info->id, kNoTriangle, place(object.frame, own), given); }, primitive);
    };
    for (const Primitive& primitive : info->primitives) visit_primitive(primitive);
    if (!info->mesh) continue;
    for (std::uint32_t i = 0; i < info->mesh->mesh->triangles.size(); ++i) {
      visit(info->id, i, place(object.frame, info->mesh->mesh->triangle(i)), object.given(i));
    }
  }
}

/// Calls visit(shape) for one triangle of the object, or for all of its primitives if triangle is kNoTriangle.
template <class Visit>
void visit_part(const Snapshot& snapshot, ObjectId object, std::uint32_t triangle, Visit&& visit) {
  const ObjectInfo& info = *snapshot.objects[slot_of(object)];
  const Frame frame = snapshot.frame(slot_of(object));
  if (triangle == kNoTriangle) {
    for (const Primitive& primitive : info.primitives) {
      std::visit([&](const auto& own) { visit(place(frame, own)); }, primitive);
    }
  } else if (info.mesh) {
    visit(place(frame, info.mesh->mesh->triangle(triangle)));
  } else {
    for (const auto& scene : snapshot.scenes) {
      if (info.scene_part >= scene->parts.size() || scene->part_objects[info.scene_part] != object) continue;
      visit(scene->mesh.triangle(scene->parts[info.scene_part].first_triangle + triangle));
    }
  }
}

}  // namespace collided::engine
