#pragma once

#include "tests/drawing/methods/buffers.hpp"

namespace collided::drawing_test {

// Silhouettes by drawing what faces away in black: the lecture's methods, each over a depth buffer of the front faces
// that the service's rays have cast. None asks which edges are silhouettes; each has a defect, and the gallery measures
// it.

/// A66: how far back faces are pulled towards the eye.
enum class Bias {
  fixed,       // the same depth everywhere
  non_linear,  // the same step of a depth buffer, which holds 1 / depth
  by_angle,    // the more the steeper the face is seen: a share of its slope in depth a pixel
};

/// Back faces in front of the front faces by the bias: lines inside of the silhouette, as wide as front and back are
/// close. amount  metres; of 1 / depth, 1 / metres; pixels
Mask biased_back_faces(const Polygons& polygons, const draw::Camera& camera, const Buffers& front, Bias bias,
                       double amount);

/// A67: back faces grown by width_px on every side of their image. A sharp corner grows by width / sin(half its angle).
Mask fattened_back_faces(const Polygons& polygons, const draw::Camera& camera, const Buffers& front, double width_px);

/// A68: back faces of a shell whose vertices were moved along their normals.
/// normals  of each vertex
Mask expanded_shell(const Polygons& polygons, const std::vector<Vec3>& normals, double distance_m,
                    const draw::Camera& camera, const Buffers& front);

/// Of each vertex the normal of its triangle: what a file with hard edges holds.
std::vector<Vec3> flat_normals(const Polygons& polygons);
/// Of each vertex the mean normal of all triangles at its place.
std::vector<Vec3> smooth_normals(const Polygons& polygons);

}  // namespace collided::drawing_test
