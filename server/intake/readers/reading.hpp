#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// The input of every reader: one file in memory, and references to the caller's options and report.
struct Reading {
  std::string file;  // its name in messages
  std::span<const char> bytes;
  const LoadOptions& options;
  LoadReport& report;
  std::shared_ptr<const void> keeper{};  // owner of the bytes, if they remain valid after the reading; may be null
  std::string folder{};                  // folder of the file; empty: none, so other files that it names cannot be read
  // Returns the memory of a piece of the bytes that is not read again, not even to count lines. Empty: nothing to do.
  // Any thread may call it.
  std::function<void(std::span<const char>)> give_back{};
  // Makes the bytes before that place readable, for a format that requests them. Empty: all are readable. Throws
  // LoadError. One thread at a time may call it.
  std::function<void(const char*)> fetch{};
  std::int64_t lines_before = 0;  // if the bytes are a piece of the file

  const char* begin() const { return bytes.data(); }
  const char* end() const { return bytes.data() + bytes.size(); }
};

/// Throws a LoadError: "bunny.obj: WHAT. Nothing was loaded."
[[noreturn]] void refuse(const Reading& reading, const std::string& what);

/// Adds the line: "bunny.obj: line 12: WHAT. Nothing was loaded." place points into the bytes.
[[noreturn]] void refuse_line(const Reading& reading, const char* place, const std::string& what);

/// Adds the byte: "bunny.stl: byte 684: WHAT. Nothing was loaded."
[[noreturn]] void refuse_byte(const Reading& reading, std::size_t byte, const std::string& what);

/// Length at which messages cut a word of a file, and a path: two paths often differ only in their last part.
constexpr std::size_t kShownOfWord = 40;
constexpr std::size_t kShownOfPath = 240;

/// A piece of the file for a message: cut to `shown` bytes, printable ASCII only, in quotes.
std::string in_quotes(std::string_view piece, std::size_t shown = kShownOfWord);

/// Throws a LoadError if the caller has cancelled the load, else reports progress, a fraction in [0, 1].
/// threads   only the one that called load_scene
void tell_progress(const Reading& reading, double fraction);

/// Each throws a LoadError if the count is above its limit.
void check_triangle_count(const Reading& reading, std::uint64_t triangle_count);
void check_vertex_count(const Reading& reading, std::uint64_t vertex_count);

/// The readers. Each turns a whole file into a mesh with parts, or throws a LoadError. Parts have the names that the
/// file gives them (empty: none); nothing is scaled or rotated yet.
Scene read_obj(const Reading& reading);
Scene read_stl(const Reading& reading);
Scene read_ply(const Reading& reading);
Scene read_off(const Reading& reading);
/// Curved surfaces, one per line, each as a part of triangles.
Scene read_surfaces(const Reading& reading);
Scene read_gltf(const Reading& reading);      // 2.0, as text or GLB
Scene read_cityjson(const Reading& reading);  // 1.0 to 2.0
/// The next two make one object, a cloud of points of radius 0.
Scene read_xyz(const Reading& reading);
Scene read_pcd(const Reading& reading);
/// The next three make objects, with the names that the file gives them.
Scene read_octomap(const Reading& reading);    // occupied cells as boxes
Scene read_box_table(const Reading& reading);  // CSV
Scene read_urdf(const Reading& reading);       // collision shapes of a robot, all joints at 0

/// Loads a file in memory: reads it, then names, scales, rotates and examines the scene. The ending of `file` selects
/// the format.
Scene load_scene_from_memory(std::span<const char> bytes, const std::string& file, const LoadOptions& options,
                             LoadReport& report);

}  // namespace collided::engine
