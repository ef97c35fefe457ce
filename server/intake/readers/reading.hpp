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

/// One file in memory on its way to a scene: what every reader gets. It refers to the caller's options and report.
struct Reading {
  std::string file;  // as messages call it
  std::span<const char> bytes;
  const LoadOptions& options;
  LoadReport& report;
  std::shared_ptr<const void> keeper{};  // of the bytes, where they stay after the reading
  std::string folder{};                  // where the file is; empty: nowhere, so files that it names cannot be read
  // Gives memory of a piece of the bytes back that is not read again, not even to number a line; empty: nothing to do.
  // Any thread.
  std::function<void(std::span<const char>)> give_back{};
  // Makes the bytes before that place readable, for a format that asks for them; empty: all are. Throws LoadError. One
  // thread at a time.
  std::function<void(const char*)> fetch{};
  std::int64_t lines_before = 0;  // of the file, where the bytes are a piece of it

  const char* begin() const { return bytes.data(); }
  const char* end() const { return bytes.data() + bytes.size(); }
};

/// "bunny.obj: WHAT. Nothing was loaded."
[[noreturn]] void refuse(const Reading& reading, const std::string& what);

/// "bunny.obj: line 12: WHAT. Nothing was loaded."; place points into the bytes.
[[noreturn]] void refuse_line(const Reading& reading, const char* place, const std::string& what);

/// "bunny.stl: byte 684: WHAT. Nothing was loaded."
[[noreturn]] void refuse_byte(const Reading& reading, std::size_t byte, const std::string& what);

/// A piece of the file made fit for a message: cut to 40 bytes, printable ASCII only, in quotes.
std::string quoted(std::string_view piece);

/// Ends the load when the caller has cancelled it, else tells how far it is.
/// threads   only the one that called load_scene
void tell_progress(const Reading& reading, double fraction);

void check_triangle_count(const Reading& reading, std::uint64_t triangle_count);
void check_vertex_count(const Reading& reading, std::uint64_t vertex_count);

/// The readers. Each turns the whole file into a mesh with parts named as in the file (empty: no name), neither
/// scaled nor turned, or throws a LoadError.
Scene read_obj(const Reading& reading);
Scene read_stl(const Reading& reading);
Scene read_ply(const Reading& reading);
Scene read_off(const Reading& reading);
/// Curved surfaces, one a line, each as a part of triangles.
Scene read_surfaces(const Reading& reading);
Scene read_gltf(const Reading& reading);      // 2.0, as text or GLB
Scene read_cityjson(const Reading& reading);  // 1.0 to 2.0
/// One object, a cloud of points without radius.
Scene read_xyz(const Reading& reading);
Scene read_pcd(const Reading& reading);
/// Objects named as in the file.
Scene read_octomap(const Reading& reading);    // occupied cells as boxes
Scene read_box_table(const Reading& reading);  // CSV
Scene read_urdf(const Reading& reading);       // collision shapes of a robot, all joints at 0

/// Reads, names, scales, turns and examines a file that is already in memory; the ending of `file` says the format.
Scene load_scene_from_memory(std::span<const char> bytes, const std::string& file, const LoadOptions& options,
                             LoadReport& report);

}  // namespace collided::engine
