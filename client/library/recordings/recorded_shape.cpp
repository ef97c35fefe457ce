#include "client/library/recordings/recorded_shape.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "client/library/commands/geometry_decoding.hpp"
#include "client/library/recordings/drawn_hull.hpp"
#include "idl/scene_tables.hpp"
#include "idl/voxel_blocks.hpp"

namespace collided::client {
namespace {

using SurfaceCorners = std::array<std::uint32_t, 3>;

void require_sound(bool holds, const char* otherwise) {
  if (!holds) throw std::runtime_error(otherwise);
}

/// A primitive with scaled lengths. A round one has the same factor for all axes.
struct ScaledPart {
  Vec3 factor;

  Vec3 at(const Vec3& point) const { return point.cwiseProduct(factor); }
  ShapePart operator()(const SphereShape& s) const { return SphereShape{s.radius_m * factor.x(), at(s.center)}; }
  ShapePart operator()(const BoxShape& b) const { return BoxShape{at(b.half_m), at(b.center), b.rotation}; }
  ShapePart operator()(const EllipsoidShape& e) const { return EllipsoidShape{at(e.half_m), at(e.center), e.rotation}; }
  ShapePart operator()(const HalfSpaceShape& h) const { return HalfSpaceShape{h.normal, at(h.point)}; }
  ShapePart operator()(const ConeShape& c) const { return ConeShape{at(c.apex), at(c.base), c.radius_m * factor.x()}; }
  template <class Round>
  requires requires(const Round& r) { r.a, r.b, r.radius_m; }
  ShapePart operator()(const Round& r) const { return Round{at(r.a), at(r.b), r.radius_m * factor.x()}; }
  template <class Other>
  ShapePart operator()(const Other& other) const {
    return other;
  }
};

class ShapeDrawing {
 public:
  ShapeDrawing(const format::Shape& from, std::size_t byte_count, const Vec3& scale, std::uint64_t first_number)
      : from_(from), budget_(byte_count), factor_(scale), next_number_(first_number) {
    if (from.scale() != nullptr)
      factor_ = factor_.cwiseProduct(Vec3(from.scale()->x(), from.scale()->y(), from.scale()->z()));
    require_sound(factor_.allFinite(), "a scale is not finite");
  }

  DrawnShape draw() {
    std::optional<Shape> primitives = decode_primitives(from_, budget_);
    require_sound(primitives.has_value(), "a primitive does not hold");
    for (const ShapePart& part : *primitives) add(part);
    each(from_.clouds(), [&](const format::Points& cloud) {
      for (const Vec3& point : points_in(cloud.points())) add(SphereShape{cloud.radius(), point});
    });
    each(from_.polylines(), [&](const format::Points& line) {
      const std::vector<Vec3> points = points_in(line.points());
      for (std::size_t i = 1; i < points.size(); ++i) add(CapsuleShape{points[i - 1], points[i], line.radius()});
    });
    each(from_.buffers(), [&](const format::VertexBuffer& buffer) { add_buffer(buffer); });
    each(from_.voxels(), [&](const format::Voxels& voxels) { add_voxels(voxels); });
    add_surfaces();
    return std::move(drawn_);
  }

 private:
  template <class Table, class Use>
  static void each(const flatbuffers::Vector<flatbuffers::Offset<Table>>* tables, const Use& use) {
    if (tables == nullptr) return;
    for (const Table* table : *tables) use(*table);
  }

  void spend(std::size_t byte_count) {
    require_sound(byte_count <= budget_, "its tables share their numbers");
    budget_ -= byte_count;
  }
  std::vector<Vec3> points_in(const flatbuffers::Vector<double>* numbers) {
    spend(numbers->size() * sizeof(double));
    std::vector<Vec3> points = format::copied<Vec3>(numbers);
    require_sound(std::ranges::all_of(points, [](const Vec3& p) { return p.allFinite(); }), "a point is not finite");
    return points;
  }

  void add(const ShapePart& part) {
    require_sound(drawn_.parts.size() < kMostDrawnParts, "a shape of too many parts");
    drawn_.parts.push_back(std::visit(ScaledPart{factor_}, part));
  }

  void add_surface(std::vector<Vec3> vertices, std::vector<SurfaceCorners> triangles, bool is_hull = false) {
    if (triangles.empty()) return;
    Surface surface{
        .number = next_number_++, .vertices = std::move(vertices), .triangles = std::move(triangles), .edges = {}};
    for (Vec3& vertex : surface.vertices) vertex = vertex.cwiseProduct(factor_).eval();
    const auto count = static_cast<std::uint32_t>(surface.triangles.size());
    drawn_.runs.push_back({std::make_shared<const Surface>(std::move(surface)), 0, count, is_hull});
  }

  void add_surfaces() {
    if (const format::Mesh* mesh = from_.mesh()) {
      std::optional<Surface> surface = decode_mesh(*mesh);
      require_sound(surface.has_value(), "a mesh does not hold");
      add_surface(std::move(surface->vertices), std::move(surface->triangles));
    }
    each(from_.hulls(), [&](const format::Mesh& mesh) {
      std::vector<Vec3> points = points_in(mesh.vertices());
      std::vector<SurfaceCorners> triangles = drawn_hull(points);
      add_surface(std::move(points), std::move(triangles), true);
    });
    if (const format::HeightField* field = from_.height_field()) add_height_field(*field);
  }

  void add_height_field(const format::HeightField& field) {
    const std::uint32_t columns = field.columns();
    const std::vector<double> heights = format::copied<double>(field.heights());
    const bool is_whole = columns >= 2 && heights.size() >= 2 * std::size_t{columns} && heights.size() % columns == 0;
    require_sound(is_whole, "a height field without whole rows");
    std::vector<Vec3> vertices;
    std::vector<SurfaceCorners> triangles;
    for (std::uint32_t i = 0; i < heights.size(); ++i) {
      vertices.emplace_back(i % columns * field.spacing_x(), i / columns * field.spacing_y(), heights[i]);
      require_sound(vertices.back().allFinite(), "a height is not finite");
      if (i % columns == columns - 1 || i + columns >= heights.size()) continue;
      triangles.push_back({i, i + 1, i + columns + 1});
      triangles.push_back({i, i + columns + 1, i + columns});
    }
    add_surface(std::move(vertices), std::move(triangles));
  }

  void add_voxels(const format::Voxels& voxels) {
    constexpr std::uint32_t kMostCells = 256;  // along an axis
    const std::array<std::uint32_t, 3> size{voxels.columns(), voxels.rows(), voxels.layers()};
    const bool are_few =
        std::ranges::all_of(size, [](std::uint32_t count) { return count >= 1 && count <= kMostCells; });
    require_sound(are_few && std::isfinite(voxels.cell()), "voxels of a size that no server takes");
    const std::size_t cells = std::size_t{size[0]} * size[1] * size[2];
    const std::span<const std::uint8_t> occupied(voxels.occupied()->data(), voxels.occupied()->size());
    const bool has_all_bits =
        occupied.size() == (cells + 7) / 8 && (cells % 8 == 0 || occupied.back() >> cells % 8 == 0);
    require_sound(has_all_bits, "voxels with other bits than their cells");
    spend(occupied.size());
    const Vec3 low(voxels.low_x(), voxels.low_y(), voxels.low_z());
    wire_contract::BlockGrowth(size, occupied).run([&](const wire_contract::CellBlock& block) {
      const Vec3 count(block.size[0], block.size[1], block.size[2]);
      const Vec3 first = low + Vec3(block.low[0], block.low[1], block.low[2]);
      add(BoxShape{count * (voxels.cell() / 2), (2 * first + count) * (voxels.cell() / 2), Quat::Identity()});
    });
  }

  static std::vector<Vec3> vertices_of(const format::VertexBuffer& buffer) {
    const std::size_t position_bytes = buffer.is_double() ? 24 : 12;
    const std::size_t stride = buffer.stride();
    const std::size_t offset = buffer.offset();
    require_sound(stride >= position_bytes && offset <= stride - position_bytes,
                  "a position does not fit into a vertex");
    std::vector<Vec3> vertices;
    const std::uint8_t* const bytes = buffer.vertices()->data();
    for (std::size_t at = offset; at + position_bytes <= buffer.vertices()->size(); at += stride) {
      std::array<float, 3> single{};
      Vec3& vertex = vertices.emplace_back();
      std::memcpy(buffer.is_double() ? static_cast<void*>(vertex.data()) : single.data(), bytes + at, position_bytes);
      if (!buffer.is_double()) vertex = Vec3(single[0], single[1], single[2]);
      require_sound(vertex.allFinite(), "a vertex is not finite");
    }
    return vertices;
  }
  static std::vector<std::uint32_t> order_of(const format::VertexBuffer& buffer, std::size_t vertex_count) {
    const std::size_t width = buffer.index_bytes();
    require_sound(width == 0 || width == 2 || width == 4, "indices of a width that no server takes");
    const std::size_t byte_count = buffer.indices() == nullptr ? 0 : buffer.indices()->size();
    std::vector<std::uint32_t> order(width == 0 ? vertex_count : byte_count / width);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      if (width == 0) order[i] = i;
      else std::memcpy(&order[i], buffer.indices()->data() + i * width, width);
      require_sound(order[i] < vertex_count, "an index names a vertex that is not there");
    }
    return order;
  }

  void add_buffer(const format::VertexBuffer& buffer) {
    using Kind = format::BufferKind;
    spend(buffer.vertices()->size() + (buffer.indices() == nullptr ? 0 : buffer.indices()->size()));
    std::vector<Vec3> vertices = vertices_of(buffer);
    const std::vector<std::uint32_t> order = order_of(buffer, vertices.size());
    std::vector<SurfaceCorners> triangles;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t last = order[i];
      const bool is_second = i >= 1;
      const bool is_third = i >= 2;
      switch (buffer.kind()) {
        case Kind::points: add(SphereShape{buffer.radius(), vertices[last]}); break;
        case Kind::segments:
        case Kind::polyline:
          if (is_second && (buffer.kind() == Kind::polyline || i % 2 == 1))
            add(CapsuleShape{vertices[order[i - 1]], vertices[last], buffer.radius()});
          break;
        case Kind::triangles:
          if (i % 3 == 2) triangles.push_back({order[i - 2], order[i - 1], last});
          break;
        case Kind::fan:
          if (is_third) triangles.push_back({order[0], order[i - 1], last});
          break;
        case Kind::strip: {
          // Every other triangle is reversed; one with two equal corners only continues the strip.
          if (!is_third) break;
          const std::uint32_t a = order[i - 2 + i % 2];
          const std::uint32_t b = order[i - 1 - i % 2];
          if (a != b && b != last && last != a) triangles.push_back({a, b, last});
          break;
        }
      }
    }
    add_surface(std::move(vertices), std::move(triangles));
  }

  const format::Shape& from_;
  std::size_t budget_;
  Vec3 factor_;
  std::uint64_t next_number_;
  DrawnShape drawn_;
};

}  // namespace

DrawnShape drawn_shape(std::span<const std::uint8_t> bytes, const Vec3& scale, std::uint64_t first_number) {
  const format::AlignedBytes aligned(std::as_bytes(bytes));
  const format::Shape* const shape = format::verified<format::Shape>(aligned.data(), bytes.size(), nullptr);
  require_sound(shape != nullptr, "its tables do not check out");
  return ShapeDrawing(*shape, bytes.size(), scale, first_number).draw();
}

}  // namespace collided::client
