#pragma once

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A sphere around the origin, of flat triangles between circles of latitude and longitude, normals outward.
///
/// longitudes  slices around the z axis, at least 3
/// latitudes   bands from pole to pole, at least 2; the bands at the poles are fans around one vertex
/// returns     2 * longitudes * (latitudes - 1) triangles, closed (16 by 9 gives 256); vertices within a few roundings
///             of the sphere, both poles and the seam shared
/// error       the triangles lie inside the sphere, at most
///             radius_m (1 - cos(pi / (2 latitudes)) cos(pi / longitudes)) deep
/// throws      std::invalid_argument for sizes or counts that do not form a sphere
TriangleMesh latitude_longitude_sphere(double radius_m, unsigned longitudes, unsigned latitudes);

/// Which way the triangles of a closed mesh face.
enum class Normals { outward, inward };

/// The 8 vertices and 12 triangles of a box; inward normals make it a room.
TriangleMesh box_mesh(const Vec3& low, const Vec3& high, Normals normals = Normals::outward);

}  // namespace collided::engine
