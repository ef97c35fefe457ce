#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "server/intake/limits.hpp"
#include "server/intake/readers/byte_order.hpp"
#include "server/intake/readers/gltf_buffers.hpp"

namespace collided::engine {
namespace {

// glTF's codes for number types and for how vertices form triangles.
enum Component : std::uint64_t { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };
enum Mode : std::uint64_t { kTriangles = 4, kStrip, kFan, kModeEnd };

/// x_parent = linear * x + offset.
struct NodePlacement {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();

  NodePlacement operator*(const NodePlacement& child) const {
    return {linear * child.linear, linear * child.offset + offset};
  }
};

Vec3 vec3(const JsonView& view) { return {view.at(std::size_t{0}).number(), view.at(1).number(), view.at(2).number()}; }

NodePlacement placement_of(const JsonView& node) {
  NodePlacement placement;
  if (node.has("matrix")) {
    const JsonView matrix = node.at("matrix");
    for (std::size_t i = 0; i < 9; ++i) placement.linear(i % 3, i / 3) = matrix.at(i / 3 * 4 + i % 3).number();
    for (std::size_t i = 0; i < 3; ++i) placement.offset[i] = matrix.at(12 + i).number();
    return placement;
  }
  if (node.has("rotation")) {
    const JsonView q = node.at("rotation");
    const Quat rotation(q.at(3).number(), q.at(std::size_t{0}).number(), q.at(1).number(), q.at(2).number());
    if (!(rotation.norm() > 0.5)) q.complain("is not a unit quaternion");
    placement.linear = rotation.normalized().toRotationMatrix();
  }
  if (node.has("scale")) placement.linear *= vec3(node.at("scale")).asDiagonal();
  if (node.has("translation")) placement.offset = vec3(node.at("translation"));
  return placement;
}

class GltfReader {
 public:
  GltfReader(const Reading& reading, const JsonView& root, std::span<const char> binary)
      : reading_(reading), root_(root), buffers_(reading, root, binary), visited_(root.size_of("nodes"), false) {}

  Scene read() {
    // No recursion: the file decides how deep its nodes are nested.
    struct Waiting {
      std::uint64_t node;
      NodePlacement parent;
    };
    std::vector<Waiting> waiting;
    const std::vector<std::uint64_t> roots = root_nodes();
    for (std::size_t i = roots.size(); i-- > 0;) waiting.push_back({roots[i], {}});
    while (!waiting.empty()) {
      const Waiting now = waiting.back();
      waiting.pop_back();
      const JsonView node = root_.element("nodes", now.node);
      if (visited_[now.node]) node.complain("stands in the scene twice or below itself");
      visited_[now.node] = true;
      const NodePlacement placement = now.parent * placement_of(node);
      if (node.has("mesh")) add_mesh(node, placement);
      for (std::size_t i = node.size_of("children"); i-- > 0;) {
        waiting.push_back({node.element("children", i).index(visited_.size()), placement});
      }
    }
    tell();
    return std::move(scene_);
  }

 private:
  std::vector<std::uint64_t> root_nodes() const {
    std::vector<std::uint64_t> roots;
    if (root_.size_of("scenes") > 0) {
      const std::uint64_t chosen = root_.index_or("scene", root_.size_of("scenes"), 0);
      if (root_.size_of("scenes") > 1) {
        reading_.report.refused.push_back(
            fmt::format("{} scenes left out; loaded is number {}", root_.size_of("scenes") - 1, chosen));
      }
      const JsonView scene = root_.element("scenes", chosen);
      for (std::size_t i = 0; i < scene.size_of("nodes"); ++i) {
        roots.push_back(scene.element("nodes", i).index(visited_.size()));
      }
      return roots;
    }
    std::vector<bool> is_child(visited_.size(), false);
    for (std::size_t n = 0; n < visited_.size(); ++n) {
      const JsonView node = root_.element("nodes", n);
      for (std::size_t i = 0; i < node.size_of("children"); ++i) {
        is_child[node.element("children", i).index(visited_.size())] = true;
      }
    }
    for (std::size_t n = 0; n < visited_.size(); ++n) {
      if (!is_child[n]) roots.push_back(n);
    }
    return roots;
  }

  void add_mesh(const JsonView& node, const NodePlacement& placement) {
    const JsonView mesh = root_.element("meshes", node.at("mesh").index(root_.size_of("meshes")));
    Part part{.name = node.text_or("name", mesh.text_or("name", "")),
              .first_triangle = static_cast<std::uint32_t>(scene_.mesh.triangles.size())};
    skin_count_ += node.has("skin") ? 1 : 0;
    for (std::size_t i = 0; i < mesh.at("primitives").size(); ++i) {
      const JsonView primitive = mesh.element("primitives", i);
      morph_count_ += primitive.size_of("targets") > 0 ? 1 : 0;
      add_primitive(primitive, placement);
    }
    part.triangle_count = static_cast<std::uint32_t>(scene_.mesh.triangles.size()) - part.first_triangle;
    if (part.triangle_count > 0) scene_.parts.push_back(std::move(part));
  }

  void add_primitive(const JsonView& primitive, const NodePlacement& placement) {
    const std::uint64_t mode = primitive.index_or("mode", kModeEnd, kTriangles);
    const JsonView attributes = primitive.at("attributes");
    if (mode < kTriangles || !attributes.has("POSITION")) {
      ++other_count_;
      return;
    }
    const std::size_t accessor_count = root_.size_of("accessors");
    const auto first = static_cast<std::uint32_t>(scene_.mesh.vertices.size());
    const std::uint64_t count =
        add_positions(root_.element("accessors", attributes.at("POSITION").index(accessor_count)), placement);
    if (!primitive.has("indices")) {
      add_triangles(mode, count, placement, [&](std::uint64_t i) { return first + static_cast<std::uint32_t>(i); });
      return;
    }
    const JsonView accessor = root_.element("accessors", primitive.at("indices").index(accessor_count));
    const std::vector<std::uint32_t> corners = indices_of(accessor, count);
    add_triangles(mode, corners.size(), placement, [&](std::uint64_t i) { return first + corners[i]; });
  }

  template <class Corner>
  void add_triangles(std::uint64_t mode, std::uint64_t corner_count, const NodePlacement& placement, Corner&& corner) {
    const std::uint64_t count = mode == kTriangles ? corner_count / 3 : corner_count < 3 ? 0 : corner_count - 2;
    check_triangle_count(reading_, scene_.mesh.triangles.size() + count);
    surplus_count_ += mode == kTriangles ? corner_count % 3 : 0;
    const bool mirrors = placement.linear.determinant() < 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      const bool turned = mode == kStrip && i % 2 == 1;
      TriangleCorners triangle = mode == kTriangles
                                     ? TriangleCorners{corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)}
                                 : mode == kStrip ? TriangleCorners{corner(i), corner(i + 1), corner(i + 2)}
                                                  : TriangleCorners{corner(i + 1), corner(i + 2), corner(0)};
      if (turned != mirrors) std::swap(triangle[1], triangle[2]);
      // A repeated corner only steers the strip and does not form a triangle.
      const bool steers = triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
      if (mode == kTriangles || !steers) scene_.mesh.triangles.push_back(triangle);
    }
  }

  /// Appends the positions of an accessor. Their number must be checked, since a file may use one mesh any number of
  /// times.
  std::uint64_t add_positions(const JsonView& accessor, const NodePlacement& placement) {
    const std::vector<double> numbers = numbers_of(accessor);
    const std::uint64_t count = numbers.size() / 3;
    check_vertex_count(reading_, scene_.mesh.vertices.size() + count);
    const std::uint64_t limit = 3 * std::min<std::uint64_t>(reading_.options.max_triangles, kMaxVertices) + 3;
    if (scene_.mesh.vertices.size() + count > limit) {
      accessor.complain(fmt::format("brings the vertices to {}, more than {} triangles can use",
                                    scene_.mesh.vertices.size() + count, reading_.options.max_triangles));
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vec3 local(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
      const Vec3 point = placement.linear * local + placement.offset;
      if (!point.allFinite()) {
        accessor.complain(fmt::format("has a vertex, number {}, that is ({}, {}, {}) where it is placed", i, point[0],
                                      point[1], point[2]));
      }
      scene_.mesh.vertices.push_back(point);
    }
    return count;
  }

  /// The numbers of an accessor, three for each element.
  std::vector<double> numbers_of(const JsonView& accessor) const {
    if (accessor.at("type").text() != "VEC3") accessor.complain("is not of type VEC3");
    const std::uint64_t count = accessor.at("count").index(kMaxVertices);
    const std::uint64_t type = accessor.at("componentType").index(kFloat + 1);
    const bool is_unit = accessor.has("normalized") && accessor.at("normalized").json() == true;
    const std::size_t bytes = 3 * component_bytes(accessor, type);
    const bool has_view = accessor.has("bufferView");
    // Without a buffer view all elements are zeros. Their number is limited, since they take no bytes in the file.
    if (!has_view && count > kMaxBareElements)
      accessor.complain(fmt::format("has {} elements and no buffer view", count));
    std::vector<double> numbers;
    if (!has_view) {
      numbers.assign(3 * count, 0);
    } else {
      const GltfBuffers::Elements elements = buffers_.elements(accessor, count, bytes);
      numbers.reserve(3 * count);
      for (std::uint64_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k) numbers.push_back(component(elements.at(i) + k * bytes / 3, type, is_unit));
      }
    }
    if (accessor.has("sparse")) replace_sparse(accessor, type, is_unit, bytes, numbers);
    return numbers;
  }

  void replace_sparse(const JsonView& accessor, std::uint64_t type, bool is_unit, std::size_t bytes,
                      std::vector<double>& numbers) const {
    const JsonView sparse = accessor.at("sparse");
    const std::uint64_t count = sparse.at("count").index(numbers.size() / 3 + 1);
    const JsonView indices = sparse.at("indices");
    const std::uint64_t index_type = indices.at("componentType").index(kFloat);
    const std::size_t index_bytes = component_bytes(indices, index_type);
    const GltfBuffers::Elements places = buffers_.elements(indices, count, index_bytes);
    const GltfBuffers::Elements values = buffers_.elements(sparse.at("values"), count, bytes);
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto place = static_cast<std::uint64_t>(component(places.at(i), index_type, false));
      if (place >= numbers.size() / 3)
        indices.complain(fmt::format("name element {} of {}", place, numbers.size() / 3));
      for (std::size_t k = 0; k < 3; ++k)
        numbers[3 * place + k] = component(values.at(i) + k * bytes / 3, type, is_unit);
    }
  }

  std::vector<std::uint32_t> indices_of(const JsonView& accessor, std::uint64_t vertex_count) const {
    if (accessor.at("type").text() != "SCALAR") accessor.complain("is not of type SCALAR");
    const std::uint64_t type = accessor.at("componentType").index(kFloat);
    if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)
      accessor.complain("holds no unsigned whole numbers");
    const std::size_t bytes = component_bytes(accessor, type);
    const std::uint64_t count = accessor.at("count").index(kMaxVertices);
    const GltfBuffers::Elements elements = buffers_.elements(accessor, count, bytes);
    std::vector<std::uint32_t> corners(count);
    for (std::uint64_t i = 0; i < count; ++i) {
      corners[i] = static_cast<std::uint32_t>(component(elements.at(i), type, false));
      if (corners[i] >= vertex_count) {
        accessor.complain(
            fmt::format("names vertex {} of {} as corner {} of triangle {}", corners[i], vertex_count, i % 3, i / 3));
      }
    }
    return corners;
  }

  static std::size_t component_bytes(const JsonView& where, std::uint64_t type) {
    switch (type) {
      case kByte:
      case kUnsignedByte: return 1;
      case kShort:
      case kUnsignedShort: return 2;
      case kUnsignedInt:
      case kFloat: return 4;
      default: where.complain(fmt::format("has component type {}, which glTF does not know", type));
    }
  }

  /// A number of an element.
  /// is_unit  whole numbers represent values in [0, 1] or [-1, 1] (KHR_mesh_quantization)
  static double component(const char* bytes, std::uint64_t type, bool is_unit) {
    const auto whole = [&]<class Number>(Number) {
      const double value = number_at<Number>(bytes, std::endian::little);
      return is_unit ? std::max(value / std::numeric_limits<Number>::max(), -1.0) : value;
    };
    switch (type) {
      case kByte: return whole(std::int8_t{});
      case kUnsignedByte: return whole(std::uint8_t{});
      case kShort: return whole(std::int16_t{});
      case kUnsignedShort: return whole(std::uint16_t{});
      case kUnsignedInt: return number_at<std::uint32_t>(bytes, std::endian::little);
      default: return number_at<float>(bytes, std::endian::little);
    }
  }

  void tell() const {
    std::vector<std::string>& refused = reading_.report.refused;
    const auto add = [&](std::uint64_t count, const char* sentence) {
      if (count > 0) refused.push_back(fmt::format("{} {}", count, sentence));
    };
    add(other_count_, "primitives of points, lines or without positions left out; only triangles are loaded");
    add(surplus_count_, "corners left over that make no triangle");
    add(skin_count_, "skins left out; their meshes stand as they were modelled");
    add(morph_count_, "morphed primitives stand as they were modelled");
    add(root_.size_of("animations"), "animations left out; the scene stands as it is");
  }

  static constexpr std::uint64_t kMaxBareElements = 1'000'000;

  const Reading& reading_;
  JsonView root_;
  GltfBuffers buffers_;
  std::vector<bool> visited_;
  Scene scene_;
  std::uint64_t other_count_ = 0;
  std::uint64_t surplus_count_ = 0;
  std::uint64_t skin_count_ = 0;
  std::uint64_t morph_count_ = 0;
};

/// Refuses a version or extensions that would change the triangles; others are about appearance.
void check_asset(const Reading& reading, const JsonView& root) {
  const std::string version = root.at("asset").text_or("version", "");
  if (!version.starts_with("2.")) {
    refuse(reading, fmt::format("glTF version {}; only 2.x is read", in_quotes(std::string_view(version))));
  }
  for (std::size_t i = 0; i < root.size_of("extensionsRequired"); ++i) {
    const std::string name = root.element("extensionsRequired", i).text();
    for (const char* hidden : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"}) {
      if (name == hidden) refuse(reading, fmt::format("its triangles are packed by {}, which is not read", name));
    }
  }
}

}  // namespace

Scene read_gltf(const Reading& reading) {
  const GltfText text = gltf_text(reading);
  const nlohmann::json document = parse_json(reading, text.json);
  const JsonView root(reading, document);
  check_asset(reading, root);
  return GltfReader(reading, root, text.binary).read();
}

}  // namespace collided::engine
