#include "server/programs/import/assimp_scene.hpp"

#include <assimp/commonMetaData.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/intake/file_bytes.hpp"
#include "server/intake/mesh/single_precision.hpp"
#include "server/intake/readers/names.hpp"
#include "server/intake/readers/reading.hpp"

namespace collided::engine {
namespace {

/// The placement of a node: x_W = linear * x + offset.
struct AssimpPlacement {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
};

AssimpPlacement operator*(const AssimpPlacement& parent, const aiMatrix4x4& m) {
  Mat3 linear;
  linear << m.a1, m.a2, m.a3, m.b1, m.b2, m.b3, m.c1, m.c2, m.c3;
  return {parent.linear * linear, parent.linear * Vec3(m.a4, m.b4, m.c4) + parent.offset};
}

/// Which axis is up in Assimp's result, by format. Assimp turns some formats so that y is up, and others not at all.
enum class Turned {
  never,        // the numbers are the file's
  from_z,       // the format has z up, and Assimp turned it about x
  as_file_says  // the file names its axis, and Assimp turned that to y unless it was told to ignore it
};

struct AssimpFormat {
  std::string_view assimp_name;  // as its metadata has it
  std::string_view name;
  Turned turned = Turned::never;
  bool in_metres = false;  // Assimp has multiplied by the unit that the file states
};
constexpr AssimpFormat kAssimpFormats[] = {
    {"Industry Foundation Classes (IFC) Importer", "IFC", Turned::from_z, true},
    {"Discreet 3DS Importer", "3DS", Turned::from_z, false},
    {"ASE Importer", "ASE", Turned::from_z, false},
    {"Collada Importer", "Collada", Turned::as_file_says, true},
    {"Autodesk FBX Importer", "FBX", Turned::never, false},
};

AssimpFormat format_of(const aiScene& scene) {
  aiString name;
  if (scene.mMetaData != nullptr) scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, name);
  for (const AssimpFormat& format : kAssimpFormats) {
    if (format.assimp_name == name.C_Str()) return format;
  }
  return {};
}

/// FBX declares its axis in the metadata, and Assimp leaves the numbers unchanged.
bool says_y_is_up(const aiScene& scene) {
  std::int32_t axis = 0;
  return scene.mMetaData != nullptr && scene.mMetaData->Get("UpAxis", axis) && axis == 1;
}

/// The turn (x, y, z) -> (x, -z, y), which takes y up to z up.
Mat3 y_to_z() {
  Mat3 turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return turn;
}

/// Undoes the quarter turn about x of a format that has z up. For IFC Assimp takes the cosine of a quarter turn in
/// single precision, which is -4e-8 and not 0: half a micrometre at 10 m, unless the same angle is turned back.
Mat3 undo_turn(std::string_view format) {
  const double cosine = format == "IFC" ? static_cast<float>(std::cos(static_cast<double>(AI_MATH_HALF_PI_F))) : 0.0;
  Mat3 undo;
  undo << 1, 0, 0, 0, cosine, -1, 0, 1, cosine;
  undo.bottomRightCorner<2, 2>() /= 1 + cosine * cosine;
  return undo;
}

/// The turn with entries rounded to whole numbers if they differ only by the rounding of a product: horizontal lines of
/// the file stay horizontal.
Mat3 without_rounding(const Mat3& turn) {
  constexpr double kFewRoundings = 0x1p-50;
  return turn.unaryExpr([](double x) { return std::abs(x - std::round(x)) <= kFewRoundings ? std::round(x) : x; });
}

/// The turn that makes z up in a scene as Assimp returned it, with a note in the report. A caller who names the axis
/// gets the file's own numbers, which are turned afterwards.
Mat3 upright(const aiScene& scene, const LoadOptions& options, LoadReport& report) {
  const AssimpFormat format = format_of(scene);
  if (format.name.empty()) return Mat3::Identity();
  const auto tell = [&](std::string_view what) {
    if (options.up == 0) report.placed.push_back(fmt::format("{}, as {} says", what, format.name));
  };
  if (format.in_metres) report.placed.push_back(fmt::format("lengths are in metres, as {} says", format.name));
  if (format.turned == Turned::from_z) {
    tell("z is up");
    return undo_turn(format.name);
  }
  if (format.turned == Turned::as_file_says) {
    tell("the up axis is turned to z");
    return options.up == 0 ? y_to_z() : Mat3::Identity();
  }
  const bool turns = says_y_is_up(scene);
  tell(turns ? "y is up and turned to z" : "z is up");
  return turns && options.up == 0 ? y_to_z() : Mat3::Identity();
}

class AssimpReader {
 public:
  /// turn  applied to the whole result of Assimp
  AssimpReader(const aiScene& from, const Mat3& turn, const LoadOptions& options, LoadReport& report)
      : from_(from), turn_(turn), options_(options), report_(report) {}

  Scene read() {
    count_names();
    // A stack of our own instead of recursion: the file chooses how deep it nests.
    std::vector<std::pair<const aiNode*, AssimpPlacement>> waiting = {{from_.mRootNode, {.linear = turn_}}};
    while (!waiting.empty()) {
      const auto [node, parent] = waiting.back();
      waiting.pop_back();
      AssimpPlacement placement = parent * node->mTransformation;
      if (node == from_.mRootNode) placement.linear = without_rounding(placement.linear);
      add_part(*node, placement);
      for (unsigned i = node->mNumChildren; i-- > 0;) { waiting.emplace_back(node->mChildren[i], placement); }
    }
    tell();
    return std::move(scene_);
  }

 private:
  void count_names() {
    std::vector<const aiNode*> waiting = {from_.mRootNode};
    while (!waiting.empty()) {
      const aiNode* node = waiting.back();
      waiting.pop_back();
      name_counts_[node->mName.C_Str()] += node->mNumMeshes > 0 ? 1 : 0;
      waiting.insert(waiting.end(), node->mChildren, node->mChildren + node->mNumChildren);
    }
  }

  /// The node's name, after its parent's if several nodes have the same: "IfcMappedItem" alone is not informative.
  std::string part_name(const aiNode& node) {
    const std::string name = node.mName.C_Str();
    const bool needs_parent = name_counts_[name] > 1 && node.mParent != nullptr && node.mParent->mName.length > 0;
    return needs_parent ? fmt::format("{}/{}", node.mParent->mName.C_Str(), name) : name;
  }

  void add_part(const aiNode& node, const AssimpPlacement& placement) {
    const std::size_t first = scene_.mesh.triangles.size();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) { add_mesh(*from_.mMeshes[node.mMeshes[i]], node, placement); }
    const std::size_t count = scene_.mesh.triangles.size() - first;
    if (count > 0) {
      scene_.parts.push_back({.name = part_name(node),
                              .first_triangle = static_cast<std::uint32_t>(first),
                              .triangle_count = static_cast<std::uint32_t>(count)});
    }
  }

  void add_mesh(const aiMesh& mesh, const aiNode& node, const AssimpPlacement& placement) {
    const std::size_t first_vertex = scene_.mesh.vertices.size();
    const std::uint64_t limit = std::min<std::uint64_t>(options_.max_triangles, 0xffffffff);
    // A file may show one mesh any number of times, so the file's size does not bound this.
    if (scene_.mesh.triangles.size() + mesh.mNumFaces > limit || first_vertex + mesh.mNumVertices > 0xffffffff) {
      throw LoadError(fmt::format("more than {} triangles", limit));
    }
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      scene_.mesh.vertices.push_back(placement.linear * Vec3(v.x, v.y, v.z) + placement.offset);
      if (!scene_.mesh.vertices.back().allFinite()) {
        throw LoadError(
            fmt::format("node {}: vertex {} is ({}, {}, {})", in_quotes(node.mName.C_Str()), i, v.x, v.y, v.z));
      }
    }
    const bool mirrors = placement.linear.determinant() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      add_face(mesh.mFaces[i], mesh.mNumVertices, static_cast<std::uint32_t>(first_vertex), mirrors);
    }
    warn_of_lost_digits(mesh, placement);
  }

  /// mirrors  the node mirrors the mesh: the order of corners is then reversed
  void add_face(const aiFace& face, unsigned vertex_count, std::uint32_t first_vertex, bool mirrors) {
    if (face.mNumIndices != 3) {
      ++other_faces_;
      return;
    }
    TriangleCorners corners{};
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= vertex_count) {
        throw LoadError(fmt::format("vertex number {} of {}", face.mIndices[k], vertex_count));
      }
      corners[k] = first_vertex + face.mIndices[k];
    }
    if (mirrors) std::swap(corners[1], corners[2]);
    scene_.mesh.triangles.push_back(corners);
  }

  // Examines the mesh before the node moves it: afterwards its numbers are no longer single precision.
  void warn_of_lost_digits(const aiMesh& mesh, const AssimpPlacement& placement) {
    if (!precision_warning_.empty()) { return; }
    TriangleMesh raw;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      raw.vertices.emplace_back(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
    }
    const double scale = std::cbrt(std::abs(placement.linear.determinant()));
    precision_warning_ = single_precision_warning(raw, options_.unit_m * scale);
  }

  void tell() {
    if (other_faces_ > 0) {
      report_.refused.push_back(
          fmt::format("{} points, lines and polygons left out; only triangles are loaded", other_faces_));
    }
    if (from_.mNumAnimations > 0) {
      report_.refused.push_back(fmt::format("{} animations left out; the scene stands as it is", from_.mNumAnimations));
    }
    if (!precision_warning_.empty()) { report_.warnings.push_back(precision_warning_); }
  }

  const aiScene& from_;
  const Mat3 turn_;
  const LoadOptions& options_;
  LoadReport& report_;
  Scene scene_;
  std::unordered_map<std::string, std::uint64_t> name_counts_;
  std::uint64_t other_faces_ = 0;
  std::string precision_warning_;
};

/// Refuses an IFC file of a schema that Assimp misreads: it supports only IFC2x3, and ends with a type error or a
/// signal on others. The schema is in the header of a STEP file (ISO 10303-21), FILE_SCHEMA(('IFC4')).
void refuse_other_ifc(const std::string& path) {
  constexpr std::size_t kHeaderBytes = 65536;
  std::string head(kHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (!head.starts_with("ISO-10303-21")) return;
  const std::size_t key = head.find("FILE_SCHEMA");
  const std::size_t open = key == std::string::npos ? key : head.find('\'', key);
  const std::size_t close = open == std::string::npos ? open : head.find('\'', open + 1);
  if (close == std::string::npos) return;
  const std::string schema = head.substr(open + 1, close - open - 1);
  if (schema.starts_with("IFC") && !schema.starts_with("IFC2X"))
    throw LoadError(fmt::format("its schema is {}, which is not read yet; IFC2x3 is. Export it as IFC2x3",
                                in_quotes(std::string_view(schema))));
}

}  // namespace

Scene read_with_assimp(const std::string& path, const LoadOptions& options, LoadReport& report) {
  refuse_other_ifc(path);
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, options.up != 0);
  const aiScene* from = importer.ReadFile(path, aiProcess_Triangulate);
  if (from == nullptr || from->mRootNode == nullptr) {
    const std::string ending = std::filesystem::path(path).extension().string();
    throw LoadError(fmt::format("it is not a readable {} file (Assimp: {})", ending, importer.GetErrorString()));
  }
  Scene scene = AssimpReader(*from, upright(*from, options, report), options, report).read();
  scene.name = options.name.empty() ? "scene" : options.name;
  if (scene.mesh.triangles.empty()) { throw LoadError("no triangles"); }
  name_parts({file_name(path), {}, options, report}, scene);
  return scene;
}

}  // namespace collided::engine
