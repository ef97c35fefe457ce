#include "server/intake/readers/vertex_buffer.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

/// The first bytes say how the rest is to be read: kind, double or not, stride, offset, bytes of an index, and where in the
/// rest the indices begin (two bytes); odd places make odd addresses.
collided::engine::VertexBuffer buffer_of(std::span<const std::byte> bytes) {
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(bytes[i]); };
  const std::span<const std::byte> rest = bytes.subspan(7);
  const std::size_t vertex_bytes = std::min(rest.size(), at(5) + 256 * at(6));
  return {.kind = static_cast<collided::engine::BufferKind>(at(0)),
          .is_double = at(1) % 2 == 1,
          .stride_bytes = at(2),
          .offset_bytes = at(3),
          .vertices = rest.first(vertex_bytes),
          .index_bytes = at(4),
          .indices = rest.subspan(vertex_bytes)};
}

std::string seed(std::uint8_t kind, bool is_double, std::uint8_t stride, std::uint8_t offset, std::uint8_t index_bytes,
                 int vertices) {
  std::string text{static_cast<char>(kind), static_cast<char>(is_double), static_cast<char>(stride),
                   static_cast<char>(offset), static_cast<char>(index_bytes)};
  const int vertex_bytes = vertices * stride;
  text += {static_cast<char>(vertex_bytes % 256), static_cast<char>(vertex_bytes / 256)};
  for (int i = 0; i < vertex_bytes; ++i)
    text += static_cast<char>(i % (is_double ? 8 : 4) == (is_double ? 7 : 3) ? 0x3f : i * 7);
  for (int i = 0; i < 12 * index_bytes; ++i)
    text += static_cast<char>(i % std::max(1, int{index_bytes}) == 0 ? i % vertices : 0);
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using collided::fuzz::require;
  if (size < 7) return 0;
  const collided::engine::VertexBuffer buffer = buffer_of(std::as_bytes(std::span(data, size)));
  const auto decoded = collided::engine::decode_buffer(buffer);
  if (std::holds_alternative<std::string>(decoded)) {
    require(!std::get<std::string>(decoded).empty(), "a refusal says why");
    return 0;
  }
  const auto& parts = std::get<collided::engine::DecodedBuffer>(decoded);
  const std::size_t vertex_count = parts.mesh.vertices.size();
  require(vertex_count <= size, "no more vertices than bytes");
  for (const collided::engine::Vec3& v : parts.mesh.vertices) require(v.allFinite(), "vertices are finite");
  for (const auto& corners : parts.mesh.triangles) {
    for (const std::uint32_t corner : corners) require(corner < vertex_count, "corners are vertices");
  }
  for (const auto& [a, b] : parts.segments) require(a < vertex_count && b < vertex_count, "ends are vertices");
  for (const std::uint32_t point : parts.points) require(point < vertex_count, "points are vertices");
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds;
  for (std::uint8_t kind = 0; kind < 6; ++kind) {
    seeds.push_back(seed(kind, false, 12, 0, 0, 6));
    seeds.push_back(seed(kind, false, 17, 5, 2, 6));
    seeds.push_back(seed(kind, true, 40, 16, 4, 6));
  }
  return seeds;
}
