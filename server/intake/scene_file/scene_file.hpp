#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/shape.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/scene.hpp"

namespace collided::engine {

/// Writes a scene as a .cscene file (idl/scene.fbs). It is first written beside the path and then renamed over it, so
/// that a process that has the old file mapped keeps it whole, and a crash leaves either the old file or the new one.
///
/// promise   load_scene returns the same bits: vertices, corners, names, shapes, poses, and the scene's indexes, which
///           follow the tables (scene_index.hpp)
/// throws    LoadError if loading would refuse the scene, if it takes 2 GiB or more, which FlatBuffers cannot address
///           (about 80 million triangles), or if the file cannot be written
void save_scene(const std::string& path, const Scene& scene);

/// Saves into an open, empty file, for a process that is not allowed to open any. `name` is for errors.
void save_scene(int file, const std::string& name, const Scene& scene);

/// Writes the checksum of a scene file's tables into them, if they are valid tables with a checksum. The last step of
/// save_scene.
void seal_scene(std::span<std::byte> tables);

/// Reads the untrusted bytes of a .cscene file. Checks the checksum (files of format 1 have none); the structure, with
/// a limit on the depth and number of tables; then the meaning: finite numbers, vertex numbers in range, parts that
/// cover the triangles once, unit quaternions, sizes of 0 or more, names valid and unique. A LoadError names what is
/// invalid.
Scene read_scene_file(const Reading& reading);

/// Limits of a shape's size.
struct ShapeLimits {
  std::uint64_t max_bytes = std::uint64_t{256} << 20;
  std::uint64_t max_triangles = 1'000'000;
  std::uint64_t max_primitives = kMaxCloudPoints;  // including the points of clouds and polylines
};

/// A shape, or why there is none, as in "sphere 2: radius -1 m, allowed are 0 and more".
struct DecodedShape {
  std::optional<Shape> shape;
  std::string refusal;
  bool is_solid = false;    // its mesh is meant to be the border of a solid; not checked
  bool by_winding = false;  // an open mesh is solid by its winding number
};

/// Decodes a FlatBuffers buffer whose root is format::Shape, with the checks of read_scene_file.
///
/// bytes     at any alignment, untrusted
/// threads   pure; memory at most a small multiple of the bytes
DecodedShape decode_shape(std::span<const std::byte> bytes, const ShapeLimits& limits = {});

/// The inverse of decode_shape.
std::vector<std::byte> encode_shape(const Shape& shape);

}  // namespace collided::engine
