#include <cmath>
#include <optional>

#include "client/library/c/values.hpp"

namespace collided::c {
namespace {

std::vector<Vec3> points_of(const collided_part& part) {
  std::vector<Vec3> points;
  points.reserve(part.point_count);
  for (std::size_t i = 0; i < part.point_count; ++i) points.push_back(vector(part.points + 3 * i));
  return points;
}

MeshShape mesh_of(const collided_part& part) {
  MeshShape mesh{.vertices = points_of(part), .triangles = {}};
  mesh.triangles.reserve(part.triangle_count);
  for (std::size_t i = 0; i < part.triangle_count; ++i) {
    const std::uint32_t* const corners = part.triangles + 3 * i;
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  return mesh;
}

Result<ShapePart> height_field_of(const collided_part& part) {
  const double columns = part.numbers[0];
  if (!(columns >= 2 && columns <= 0x7fffffff && columns == std::floor(columns))) {
    return Error{ErrorCode::bad_input,
                 "a height field of " + std::to_string(columns) + " columns; a whole number from 2",
                 "nothing was sent"};
  }
  return ShapePart(HeightFieldShape{.columns = static_cast<std::uint32_t>(columns),
                                    .spacing_x_m = part.numbers[1],
                                    .spacing_y_m = part.numbers[2],
                                    .heights_m = {part.points, part.points + part.point_count}});
}

Result<ShapePart> part_of(const collided_part& part) {
  if ((part.point_count > 0 && !part.points) || (part.triangle_count > 0 && !part.triangles)) {
    return missing("an array of a part");
  }
  const double* const n = part.numbers;
  switch (part.kind) {
    case COLLIDED_SPHERE: return ShapePart(SphereShape{.radius_m = n[3], .center = vector(n)});
    case COLLIDED_BOX:
      return ShapePart(BoxShape{.half_m = vector(n), .center = vector(n + 3), .rotation = rotation(n + 6)});
    case COLLIDED_CAPSULE: return ShapePart(CapsuleShape{.a = vector(n), .b = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_CYLINDER: return ShapePart(CylinderShape{.a = vector(n), .b = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_CONE: return ShapePart(ConeShape{.apex = vector(n), .base = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_ELLIPSOID:
      return ShapePart(EllipsoidShape{.half_m = vector(n), .center = vector(n + 3), .rotation = rotation(n + 6)});
    case COLLIDED_HALF_SPACE: return ShapePart(HalfSpaceShape{.normal = vector(n), .point = vector(n + 3)});
    case COLLIDED_HULL: return ShapePart(HullShape{.points = points_of(part)});
    case COLLIDED_MESH: return ShapePart(mesh_of(part));
    case COLLIDED_HEIGHT_FIELD: return height_field_of(part);
    case COLLIDED_CLOUD: return ShapePart(CloudShape{.points = points_of(part), .radius_m = n[0]});
    case COLLIDED_POLYLINE: return ShapePart(PolylineShape{.points = points_of(part), .radius_m = n[0]});
    default: break;
  }
  return Error{ErrorCode::bad_input, "a part of kind " + std::to_string(part.kind) + "; known are 0 to 11",
               "nothing was sent"};
}

}  // namespace

Result<Shape> shape_of(const collided_part* parts, std::size_t part_count) {
  if (part_count > 0 && !parts) return missing("parts");
  // The parts lie as far from each other as the caller's header says.
  const auto* bytes = reinterpret_cast<const unsigned char*>(parts);
  Shape made;
  for (std::size_t i = 0; i < part_count; ++i, bytes += parts->size) {
    Result<ShapePart> part = part_of(taken(reinterpret_cast<const collided_part*>(bytes)));
    if (!part) return part.error();
    made.push_back(std::move(*part));
  }
  return made;
}

Result<ObjectOptions> object_options(const collided_object* object) {
  if (!object) return missing("object");
  collided_object defaults;
  collided_object_defaults(&defaults, sizeof defaults);
  const collided_object given = taken(object, defaults);
  ObjectOptions made;
  made.name = text(given.name);
  made.scale = vector(given.scale);
  made.pose = {vector(given.position), rotation(given.orientation)};
  made.layers = given.layers;
  made.mask = given.mask;
  made.group = given.group;
  made.moving = given.moving != 0;
  made.solid = given.solid != 0;
  made.solid_by_winding = given.solid == 2;
  made.lost_policy = static_cast<LostPolicy>(given.lost_policy);
  Result<Shape> shape = shape_of(given.parts, given.part_count);
  if (!shape) return shape.error();
  made.shape = std::move(*shape);
  return made;
}

}  // namespace collided::c

using namespace collided;
using namespace collided::c;

extern "C" {

void collided_object_defaults(collided_object* object, uint32_t size) {
  if (!object) return;
  object->size = size;
  collided_object defaults{};
  defaults.layers = 1;
  defaults.mask = 0xffffffff;
  defaults.moving = 1;
  std::fill_n(defaults.scale, 3, 1.0);
  defaults.orientation[0] = 1;
  give(defaults, object);
}

int collided_add(collided_client* client, const collided_object* object, uint64_t* object_id, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<ObjectOptions> options = object_options(object);
    if (!options) return options.error();
    const Result<Added> added = client->client.add(*options);
    if (!added) return added.error();
    if (object_id) *object_id = added->id;
    return {};
  });
}

int collided_move(collided_client* client, const char* name, const double* position, const double* orientation,
                  int32_t teleport, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!position) return missing("position");
    const Result<Moved> moved =
        client->client.move(text(name), {vector(position), rotation(orientation)}, teleport != 0);
    if (!moved) return moved.error();
    return {};
  });
}

int collided_remove(collided_client* client, const char* name, uint64_t* removed, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<Removed> gone = client->client.remove(text(name));
    if (!gone) return gone.error();
    if (removed) *removed = gone->names.size();
    return {};
  });
}

int collided_allow(collided_client* client, const char* a, const char* b, const char* because, uint64_t* ended,
                   collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<RuleChanged> changed = client->client.allow(text(a), text(b), text(because));
    if (!changed) return changed.error();
    if (ended) *ended = changed->contacts;
    return {};
  });
}

int collided_deny(collided_client* client, const char* a, const char* b, uint64_t* began, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<RuleChanged> changed = client->client.deny(text(a), text(b));
    if (!changed) return changed.error();
    if (began) *began = changed->contacts;
    return {};
  });
}

int collided_attach(collided_client* client, const char* child, const char* parent, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<Attached> attached = client->client.attach(text(child), text(parent));
    if (!attached) return attached.error();
    return {};
  });
}

int collided_detach(collided_client* client, const char* child, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<Attached> detached = client->client.detach(text(child));
    if (!detached) return detached.error();
    return {};
  });
}

}  // extern "C"
