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

/// Writes a scene as a .cscene file (idl/scene.fbs): beside the path first, then renamed over it, so that who has the
/// old file mapped keeps it whole and a crash leaves one of the two.
///
/// promise   load_scene gives the same bits back: vertices, corners, names, shapes, poses, and the indexes that the
///           scene has, behind the tables (scene_index.hpp)
/// throws    LoadError when the scene holds what loading would refuse, needs 2 GiB or more (what FlatBuffers can
///           address: about 80 M triangles), or the file cannot be written
void save_scene(const std::string& path, const Scene& scene);

/// The same to a file that is open already and empty, for a process that may open none; `name` is for complaints.
void save_scene(int file, const std::string& name, const Scene& scene);

/// Makes the checksum of a scene file's tables theirs, where they are tables and have one; what save_scene does last.
void seal_scene(std::span<std::byte> tables);

/// The scene in the bytes of a .cscene file. Its checksum fits (files of format 1 have none); structure is verified with bounded depth and count of tables, then
/// meaning: finite numbers, vertex numbers in range, parts that tile the triangles, unit quaternions, sizes >= 0,
/// names unique and fit. All of it holds or a LoadError says what does not.
Scene read_scene_file(const Reading& reading);

struct ShapeLimits {
  std::uint64_t max_bytes = std::uint64_t{256} << 20;
  std::uint64_t max_triangles = 1'000'000;
  std::uint64_t max_primitives = kMaxCloudPoints;  // points of clouds and lines too
};

/// A shape, or why there is none ("sphere 2: radius -1 m, allowed are 0 and more").
struct DecodedShape {
  std::optional<Shape> shape;
  std::string refusal;
};

/// The shape in a FlatBuffers buffer whose root is format::Shape, with the checks of read_scene_file.
/// bytes     at any alignment, from anybody
/// threads   pure; memory at most a small multiple of the bytes
DecodedShape decode_shape(std::span<const std::byte> bytes, const ShapeLimits& limits = {});

/// What decode_shape reads.
std::vector<std::byte> encode_shape(const Shape& shape);

}  // namespace collided::engine
