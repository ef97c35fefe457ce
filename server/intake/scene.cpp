#include "server/intake/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "server/intake/converter.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/mesh/mend.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/mesh/single_precision.hpp"
#include "server/intake/parallel.hpp"
#include "server/intake/readers/names.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/intake/streamed_mesh.hpp"
#include "server/intake/tiles/ply_source.hpp"
#include "server/intake/tiles/tile_reader.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

/// The result of a reader: one mesh in parts, one cloud of points, separate objects, a whole saved scene, or the needed
/// tiles of a saved scene.
enum class Content { mesh, cloud, objects, saved, tiles };

/// Properties of a format that are known before a file is read.
struct FileFormat {
  const char* ending;
  const char* name;
  Content content;
  Scene (*read)(const Reading&);
  bool says_metres = false;     // the format is defined in metres
  char up = 0;                  // the axis that the format defines to be up; 0: none
  bool asks_for_bytes = false;  // its reader calls Reading::fetch, so the file is copied in steps
};

constexpr FileFormat kFormats[] = {
    {".obj", "OBJ", Content::mesh, read_obj, false, 0, true},
    {".stl", "STL", Content::mesh, read_stl},
    {".ply", "PLY", Content::mesh, read_ply},
    {".off", "OFF", Content::mesh, read_off},
    {".surfaces", "the list of surfaces", Content::mesh, read_surfaces},
    {".gltf", "glTF", Content::mesh, read_gltf, true, 'y'},
    {".glb", "glTF", Content::mesh, read_gltf, true, 'y'},
    {".json", "CityJSON", Content::mesh, read_cityjson, true, 'z'},
    {".cityjson", "CityJSON", Content::mesh, read_cityjson, true, 'z'},
    {".xyz", "XYZ", Content::cloud, read_xyz},
    {".pcd", "PCD", Content::cloud, read_pcd},
    {".bt", "OctoMap", Content::objects, read_octomap, true, 'z'},
    {".csv", "CSV", Content::objects, read_box_table},
    {".urdf", "URDF", Content::objects, read_urdf, true, 'z'},
    {".cscene", "the scene file", Content::saved, read_scene_file, true, 'z'},
    {".ctiles", "the tile file", Content::tiles, read_tiles, true, 'z'},
};
/// Any other format: the converter process turns the file into a scene file.
constexpr FileFormat kOther{"", "the converter", Content::saved, nullptr};

const FileFormat& format_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  const auto found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                  [&](const FileFormat& format) { return format.ending == ending; });
  return found == std::end(kFormats) ? kOther : *found;
}

std::string scene_name(const std::string& file, const LoadOptions& options) {
  const std::string name = options.name.empty() ? std::filesystem::path(file).stem().string() : options.name;
  return mended_name(name.empty() ? "scene" : name);
}

void check_options(const Reading& reading) {
  if (!(reading.options.unit_m > 0 && std::isfinite(reading.options.unit_m))) {
    refuse(reading, fmt::format("unit of {} m, allowed are finite lengths above 0", reading.options.unit_m));
  }
  if (!(reading.options.radius_m >= 0 && std::isfinite(reading.options.radius_m))) {
    refuse(reading, fmt::format("radius {} m, allowed are finite lengths of 0 and more", reading.options.radius_m));
  }
  if (reading.options.up != 0 && reading.options.up != 'y' && reading.options.up != 'z') {
    refuse(reading, fmt::format("up axis {}, allowed are 'y' and 'z'", in_quotes({&reading.options.up, 1})));
  }
}

/// The bytes without the byte order mark that a text editor may write first.
std::span<const char> without_mark(const Reading& reading) {
  const std::string_view text(reading.begin(), reading.bytes.size());
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    refuse(reading, "the text is UTF-16; write it as UTF-8 or ASCII");
  }
  return reading.bytes.subspan(text.starts_with("\xef\xbb\xbf") ? 3 : 0);
}

TriangleMesh scaled(TriangleMesh mesh, double unit_m) {
  for (Vec3& vertex : mesh.vertices) { vertex *= unit_m; }
  return mesh;
}

Vec3 turned_up(const Vec3& v) { return {v[0], -v[2], v[1]}; }

/// Reason for the unit or axis: given by the caller or the format, or assumed.
std::string because(const FileFormat& format, bool is_asked, bool is_said, std::string_view option) {
  if (is_asked) return "as asked";
  return is_said ? fmt::format("as {} says", format.name)
                 : fmt::format("since {} does not say; {} does", format.name, option);
}

/// Reports the unit, up axis and origin that were used, and why.
void tell_placement(const FileFormat& format, const Reading& reading) {
  const LoadOptions& options = reading.options;
  const char up = options.up != 0 ? options.up : format.up;
  std::vector<std::string>& placed = reading.report.placed;
  // A converter reports its own choices; what it could not determine is reported here.
  const auto told = [&](std::string_view what) {
    return std::any_of(placed.begin(), placed.end(),
                       [&](const std::string& line) { return line.find(what) != std::string::npos; });
  };
  if (options.unit_m != 1 || !told("lengths are in metres")) {
    placed.push_back(fmt::format("a unit of the file is {} m, {}", options.unit_m,
                                 because(format, options.unit_m != 1, format.says_metres, "--unit")));
  }
  if (options.up != 0 || !(told("is up") || told("the up axis"))) {
    placed.push_back(fmt::format("{}, {}", up == 'y' ? "y is up and turned to z" : "z is up",
                                 because(format, options.up != 0, format.up != 0, "--up")));
  }
  placed.emplace_back("the origin is that of the file");
}

bool turns_y_up(const FileFormat& format, const LoadOptions& options) {
  return (options.up != 0 ? options.up : format.up) == 'y';
}

/// Converts the scene from the file's unit and axes to metres with z up. Numbers do not change if that is so already.
void place(const FileFormat& format, const Reading& reading, Scene& scene) {
  tell_placement(format, reading);
  const double unit_m = reading.options.unit_m;
  const bool turns = turns_y_up(format, reading.options);
  if (unit_m != 1) { scene.mesh = scaled(std::move(scene.mesh), unit_m); }
  for (Vec3& vertex : scene.mesh.vertices) {
    if (turns) { vertex = turned_up(vertex); }
    if (unit_m != 1 && !vertex.allFinite()) {
      refuse(reading, fmt::format("a coordinate times {} m is too large for a double", unit_m));
    }
  }
  if (unit_m != 1 || turns) forget_indexes(scene);
  const Quat quarter_turn(std::sqrt(0.5), std::sqrt(0.5), 0, 0);  // around x
  for (SceneObject& object : scene.objects) {
    if (unit_m != 1) {
      if (const std::string reason = scale(object.shape, Vec3::Constant(unit_m)); !reason.empty()) {
        refuse(reading, fmt::format("object {}: {}", in_quotes(std::string_view(object.name)), reason));
      }
      object.pose.position *= unit_m;
    }
    if (turns) {
      object.pose.position = turned_up(object.pose.position);
      object.pose.rotation = (quarter_turn * object.pose.rotation).normalized();
    }
  }
}

struct Oddities {
  std::uint64_t equal_vertices = 0;
  std::uint64_t zero_areas = 0;
  std::uint64_t duplicates = 0;
};

Oddities count_oddities(const Reading& reading, const TriangleMesh& mesh) {
  constexpr std::size_t kPiece = 0x10000;
  const std::size_t triangle_count = mesh.triangles.size();
  const std::size_t piece_count = (triangle_count + kPiece - 1) / kPiece;
  Oddities found;
  std::atomic<std::uint64_t> zero_areas = 0;
  const auto task = [&](std::size_t task_index) {
    if (task_index == 0) {
      const std::vector<std::uint32_t> first_equal = first_equal_vertices(mesh.vertices);
      for (std::uint32_t i = 0; i < first_equal.size(); ++i) { found.equal_vertices += first_equal[i] == i ? 0 : 1; }
      found.duplicates = duplicate_triangles(mesh, first_equal).size();
      return;
    }
    const std::size_t end = std::min(task_index * kPiece, triangle_count);
    for (std::size_t i = (task_index - 1) * kPiece; i < end; ++i) {
      if (has_zero_area(mesh.triangle(static_cast<std::uint32_t>(i)))) {
        zero_areas.fetch_add(1, std::memory_order_relaxed);
      }
    }
  };
  run_in_parallel(1 + piece_count, task, [&](std::size_t done) {
    tell_progress(reading, 0.8 + 0.2 * static_cast<double>(done) / static_cast<double>(1 + piece_count));
  });
  found.zero_areas = zero_areas.load();
  return found;
}

void report_oddities(const Reading& reading, const TriangleMesh& mesh) {
  const Oddities found = count_oddities(reading, mesh);
  const auto tell = [&](std::uint64_t count, std::string_view sentence) {
    if (count > 0) { reading.report.warnings.push_back(fmt::format("{} {}", count, sentence)); }
  };
  tell(found.zero_areas, "triangles without area kept, as the segments or points they are");
  tell(found.duplicates, "triangles with the three points of another one kept");
  tell(found.equal_vertices, "vertices with the coordinates of another one kept");
}

/// Mends the meshes if requested, and reports anomalies.
void finish_mesh(const Reading& reading, Scene& scene) {
  const auto tell = [&](const std::vector<std::string>& lines) {
    reading.report.mended.insert(reading.report.mended.end(), lines.begin(), lines.end());
  };
  if (reading.options.mend_m && !scene.mesh.triangles.empty()) tell(sentences(mend(scene, *reading.options.mend_m)));
  if (reading.options.mend_m) tell(mend_objects(scene, *reading.options.mend_m));
  report_oddities(reading, scene.mesh);
}

void check_mesh(const Reading& reading, const Scene& scene) {
  if (scene.mesh.triangles.empty()) {
    refuse(reading, fmt::format("no triangles ({} vertices)", scene.mesh.vertices.size()));
  }
  if (std::string warning = single_precision_warning(scene.mesh, reading.options.unit_m); !warning.empty()) {
    reading.report.warnings.push_back(std::move(warning));
  }
}

/// Gives the points of a cloud their radius, which is in metres regardless of the file's unit.
void set_radius(const Reading& reading, SceneObject& cloud) {
  for (Primitive& point : cloud.shape.primitives) { std::get<Sphere>(point).radius_m = reading.options.radius_m; }
  if (reading.options.radius_m == 0) {
    reading.report.warnings.emplace_back("the points have no radius, so that hardly a ray meets one");
  }
}

/// Releases the memory of the file's bytes, since the steps after reading need memory themselves.
void drop_bytes(Reading& reading) {
  if (reading.give_back) reading.give_back(reading.bytes);
  reading.bytes = {};
}

/// No number may be so large that distances overflow.
void refuse_beyond_limit(const Reading& reading, const Scene& scene) {
  if (const std::string reason = beyond_limit(scene.mesh); !reason.empty()) refuse(reading, reason);
  for (const SceneObject& object : scene.objects) {
    std::string reason = beyond_limit(object.pose.position);
    if (reason.empty()) reason = beyond_limit(object.shape);
    if (!reason.empty())
      refuse(reading, fmt::format("object {}: {}", in_quotes(std::string_view(object.name)), reason));
  }
}

Scene load(const FileFormat& format, Reading reading) {
  check_options(reading);
  tell_progress(reading, 0);
  if (format.read == nullptr) {
    std::string endings;
    for (const FileFormat& known : kFormats) endings += fmt::format(" {}", known.ending);
    refuse(reading, fmt::format("the ending is none of{}", endings));
  }
  const bool was_saved = format.content == Content::saved || format.content == Content::tiles;
  if (!was_saved) reading.bytes = without_mark(reading);
  Scene scene = format.read(reading);
  if (!was_saved) drop_bytes(reading);
  if (format.content == Content::mesh) check_mesh(reading, scene);
  if (was_saved) {
    if (!reading.options.name.empty()) rename_scene(reading, scene, mended_name(reading.options.name));
  } else {
    scene.name = scene_name(reading.file, reading.options);
    name_parts(reading, scene);
  }
  if (scene.frozen && (reading.options.unit_m != 1 || turns_y_up(format, reading.options)))
    refuse(reading, "a snapshot is in metres with z up, and what it covers stays where it is");
  place(format, reading, scene);
  if (format.content == Content::cloud) set_radius(reading, scene.objects.front());
  if (!was_saved || reading.options.unit_m != 1) refuse_beyond_limit(reading, scene);
  // A saved scene was examined when it was saved.
  if (format.content == Content::mesh || reading.options.mend_m) finish_mesh(reading, scene);
  tell_progress(reading, 1);
  return scene;
}

/// How a file of the format is brought into memory.
FileBytes::Access access_to(const FileFormat& format) {
  if (format.content == Content::tiles) return FileBytes::Access::mapped_as_read;
  if (format.content == Content::saved) return FileBytes::Access::mapped;
  return format.asks_for_bytes ? FileBytes::Access::copied_as_asked : FileBytes::Access::copied;
}

/// Has the converter process read an untrusted file of a format that this process could read too. Its result is checked
/// like any scene file.
Scene load_apart(const std::string& path, const LoadOptions& options, LoadReport& report) {
  const ConvertedFile converted(path, scene_name(path, options), options, report);
  const auto bytes = std::make_shared<FileBytes>(converted.path(), FileBytes::Access::copied, LoadOptions{});
  LoadOptions rest;
  rest.max_triangles = options.max_triangles;
  rest.progress = options.progress;
  rest.cancelled = options.cancelled;
  return read_scene_file({file_name(path), bytes->bytes(), rest, report, bytes});
}

Scene load_converted(const std::string& path, const LoadOptions& options, LoadReport& report) {
  const ConvertedFile converted(path, scene_name(path, options), options, report);
  const FileBytes bytes(converted.path(), FileBytes::Access::mapped,
                        {});  // the limit on bytes is for the original file
  const Reading reading{file_name(path), bytes.bytes(), options, report};
  check_options(reading);
  Scene scene = read_scene_file(reading);
  place(kOther, reading, scene);
  if (options.unit_m != 1) refuse_beyond_limit(reading, scene);
  finish_mesh(reading, scene);
  tell_progress(reading, 1);
  return scene;
}

/// The program that unpacks a file of this name; nothing if it is not packed.
std::string unpacker_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  for (const auto& [packed, tool] : {std::pair(".gz", "gunzip"), std::pair(".xz", "unxz"), std::pair(".bz2", "bunzip2"),
                                     std::pair(".zst", "unzstd"), std::pair(".zip", "unzip")}) {
    if (ending == packed) return tool;
  }
  return {};
}

}  // namespace

std::optional<StreamedMesh> stream_mesh(const std::string& path, const LoadOptions& options, LoadReport& report) {
  const FileFormat& format = format_of(path);
  if (format.read != &read_ply || options.mend_m || options.strict) return std::nullopt;
  constexpr std::size_t kHeaderBytes = std::size_t{1} << 20;
  LoadOptions without_limits;
  without_limits.max_file_bytes = std::numeric_limits<std::uint64_t>::max();
  FileBytes bytes(path, FileBytes::Access::copied_as_asked, without_limits);
  bytes.fetch_before(kHeaderBytes);
  const Reading reading{file_name(path), bytes.bytes(), options, report};
  const std::string_view beginning(reading.begin(), std::min(kHeaderBytes, reading.bytes.size()));
  if (beginning.find("end_header\n") == std::string_view::npos) return std::nullopt;
  check_options(reading);
  StreamedMesh streamed;
  streamed.mesh = PlySource::open(reading, parse_ply_header(reading), path,
                                  {.unit_m = options.unit_m, .turns_y_up = turns_y_up(format, options)});
  if (!streamed.mesh || streamed.mesh->triangle_count() == 0) return std::nullopt;
  Scene scene{.name = scene_name(reading.file, options)};
  scene.parts.push_back({.name = {}, .triangle_count = static_cast<std::uint32_t>(streamed.mesh->triangle_count())});
  name_parts(reading, scene);
  tell_placement(format, reading);
  report.notes.emplace_back("read piece by piece; what is odd about it was not looked for, 'collide check' does");
  streamed.name = std::move(scene.name);
  streamed.parts = std::move(scene.parts);
  return streamed;
}

bool is_read_here(const std::string& path) { return format_of(path).read != nullptr; }

Scene load_scene_from_memory(std::span<const char> bytes, const std::string& file, const LoadOptions& options,
                             LoadReport& report) {
  return load(format_of(file), {file, bytes, options, report});
}

Scene load_scene(const std::string& path, const LoadOptions& options, LoadReport& report) {
  const auto begin = std::chrono::steady_clock::now();
  const FileFormat& format = format_of(path);
  if (!options.srdf.empty() && format.read != &read_urdf)
    throw LoadError(fmt::format("{}: --srdf is for .urdf robots. Nothing was loaded.", file_name(path)));
  if (const std::string tool = unpacker_of(path); format.read == nullptr && !tool.empty())
    throw LoadError(
        fmt::format("{}: it is packed; unpack it first, by {}. Nothing was loaded.", file_name(path), tool));
  Scene scene;
  if (format.read == nullptr) {
    scene = load_converted(path, options, report);
  } else if (options.is_foreign) {
    scene = load_apart(path, options, report);
  } else {
    const FileBytes::Access access = access_to(format);
    const auto bytes = std::make_shared<FileBytes>(path, access, options);
    const std::string folder = std::filesystem::absolute(path).parent_path().string();
    const auto give_back = [&](std::span<const char> piece) { bytes->give_back(piece); };
    const auto fetch = [&](const char* end) {
      bytes->fetch_before(static_cast<std::size_t>(end - bytes->bytes().data()));
    };
    scene = load(format, {file_name(path), bytes->bytes(), options, report, bytes, folder, give_back, fetch});
    // Saved indexes remain in use in the last part of the mapping.
    if (access == FileBytes::Access::mapped) bytes->forget_before(table_bytes(bytes->bytes()));
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return scene;
}

}  // namespace collided::engine
