#include "server/intake/tiles/ply_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "server/intake/file_bytes.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/readers/byte_order.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kBlockRows = 512;
constexpr std::size_t kBlocks = 4096;        // some 30 MB of vertices in single precision
constexpr std::size_t kPieceRows = 0x10000;  // faces that are read together

bool is_scalar(const PlyProperty& property) { return !property.count_type; }

/// The bytes before a row's property, if only numbers precede it.
std::size_t offset_of(const PlyElement& element, int property) {
  std::size_t offset = 0;
  for (int i = 0; i < property; ++i) offset += byte_count(element.properties[static_cast<std::size_t>(i)].type);
  return offset;
}

}  // namespace

PlySource::PlySource(const Reading& reading, const std::string& path, const VertexPlacing& placing)
    : name_(reading.file), placing_(placing), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)), blocks_(kBlocks) {
  if (file_ < 0) refuse_file(name_, fmt::format("cannot be opened: {}", std::strerror(errno)));
}

PlySource::~PlySource() {
  if (file_ >= 0) ::close(file_);
}

std::unique_ptr<PlySource> PlySource::open(const Reading& reading, const PlyHeader& header, const std::string& path,
                                           const VertexPlacing& placing) {
  std::unique_ptr<PlySource> source(new PlySource(reading, path, placing));
  if (!source->has_layout(header, reading.bytes.size())) return nullptr;
  return source->check_rows(reading) ? std::move(source) : nullptr;
}

/// True if the file has vertices and then faces, each in rows of one length if all faces are triangles, and nothing
/// else.
bool PlySource::has_layout(const PlyHeader& header, std::uint64_t file_bytes) {
  if (header.format == PlyFormat::text || header.elements.size() != 2) return false;
  order_ = header.format == PlyFormat::big_endian ? std::endian::big : std::endian::little;
  const PlyElement& vertex = header.elements[0];
  const PlyElement& face = header.elements[1];
  if (vertex.name != "vertex" || face.name != "face") return false;
  if (!std::ranges::all_of(vertex.properties, is_scalar)) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int property = vertex.find(std::string_view("xyz").substr(axis, 1));
    if (property < 0) return false;
    axes_[axis] = {offset_of(vertex, property), vertex.properties[static_cast<std::size_t>(property)].type};
  }
  int list = face.find("vertex_indices");
  list = list < 0 ? face.find("vertex_index") : list;
  if (list < 0 || std::ranges::count_if(face.properties, is_scalar) + 1 != std::ssize(face.properties)) return false;
  const PlyProperty& corners = face.properties[static_cast<std::size_t>(list)];
  const bool is_byte = corners.count_type == PlyType::uint8 || corners.count_type == PlyType::int8;
  if (!is_byte || (corners.type != PlyType::int32 && corners.type != PlyType::uint32)) return false;
  count_offset_ = offset_of(face, list);
  vertices_ = {header.body_byte, vertex.row_count, offset_of(vertex, static_cast<int>(vertex.properties.size()))};
  faces_ = {vertices_.first_byte + vertices_.count * vertices_.row_bytes, face.row_count,
            1 + 3 * sizeof(std::uint32_t)};
  for (const PlyProperty& property : face.properties)
    faces_.row_bytes += is_scalar(property) ? byte_count(property.type) : 0;
  return vertices_.count <= kMaxVertices && faces_.count <= kMaxVertices && faces_.first_byte <= file_bytes &&
         faces_.count <= (file_bytes - faces_.first_byte) / faces_.row_bytes;
}

/// False if a face is not a triangle.
bool PlySource::check_rows(const Reading& reading) {
  for (std::uint64_t i = 0; i < vertices_.count; ++i) {
    if (i % kPieceRows == 0)
      tell_progress(reading, 0.5 * static_cast<double>(i) / static_cast<double>(vertices_.count));
    const Vec3 v = vertex(static_cast<std::uint32_t>(i));
    if (!v.allFinite())
      refuse_byte(reading, vertices_.first_byte + i * vertices_.row_bytes,
                  fmt::format("vertex {} is ({}, {}, {})", i, v[0], v[1], v[2]));
  }
  std::vector<char> rows(kPieceRows * faces_.row_bytes);
  for (std::uint64_t first = 0; first < faces_.count; first += kPieceRows) {
    tell_progress(reading, 0.5 + 0.5 * static_cast<double>(first) / static_cast<double>(faces_.count));
    const std::size_t count = std::min<std::uint64_t>(kPieceRows, faces_.count - first);
    const std::uint64_t first_byte = faces_.first_byte + first * faces_.row_bytes;
    read(first_byte, std::span(rows).first(count * faces_.row_bytes));
    for (std::size_t i = 0; i < count; ++i) {
      const char* const list = rows.data() + i * faces_.row_bytes + count_offset_;
      if (*list != 3) return false;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = number_at<std::uint32_t>(list + 1 + k * sizeof(std::uint32_t), order_);
        if (corner >= vertices_.count)
          refuse_byte(reading, first_byte + i * faces_.row_bytes,
                      fmt::format("vertex number {}, allowed 0 to {}", corner, vertices_.count - 1));
      }
    }
  }
  return true;
}

void PlySource::visit_triangles(const std::function<void(std::uint32_t, std::span<const TriangleCorners>)>& visit) {
  std::vector<char> rows(kPieceRows * faces_.row_bytes);
  std::vector<TriangleCorners> triangles;
  for (std::uint64_t first = 0; first < faces_.count; first += kPieceRows) {
    const std::size_t count = std::min<std::uint64_t>(kPieceRows, faces_.count - first);
    read(faces_.first_byte + first * faces_.row_bytes, std::span(rows).first(count * faces_.row_bytes));
    triangles.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const char* const corners = rows.data() + i * faces_.row_bytes + count_offset_ + 1;
      for (std::size_t k = 0; k < 3; ++k)
        triangles[i][k] = number_at<std::uint32_t>(corners + k * sizeof(std::uint32_t), order_);
    }
    visit(static_cast<std::uint32_t>(first), triangles);
  }
}

Vec3 PlySource::vertex(std::uint32_t number) {
  const char* const row = row_of(number);
  Vec3 v;
  for (std::size_t axis = 0; axis < 3; ++axis) v[static_cast<Eigen::Index>(axis)] = coordinate(row, axes_[axis]);
  if (placing_.unit_m != 1) v *= placing_.unit_m;
  return placing_.turns_y_up ? Vec3(v[0], -v[2], v[1]) : v;
}

const char* PlySource::row_of(std::uint32_t number) {
  if (number >= vertices_.count) refuse_file(name_, "it changed while it was read");
  const std::uint64_t block_number = number / kBlockRows;
  VertexBlock& block = blocks_[block_number % kBlocks];
  if (block.number != block_number || block.bytes.empty()) {
    const std::uint64_t first = block_number * kBlockRows;
    block.number = block_number;
    block.bytes.resize(std::min<std::uint64_t>(kBlockRows, vertices_.count - first) * vertices_.row_bytes);
    read(vertices_.first_byte + first * vertices_.row_bytes, block.bytes);
  }
  return block.bytes.data() + number % kBlockRows * vertices_.row_bytes;
}

double PlySource::coordinate(const char* row, const Coordinate& of) const {
  const char* const at = row + of.offset;
  switch (of.type) {
    case PlyType::int8: return number_at<std::int8_t>(at, order_);
    case PlyType::uint8: return number_at<std::uint8_t>(at, order_);
    case PlyType::int16: return number_at<std::int16_t>(at, order_);
    case PlyType::uint16: return number_at<std::uint16_t>(at, order_);
    case PlyType::int32: return number_at<std::int32_t>(at, order_);
    case PlyType::uint32: return number_at<std::uint32_t>(at, order_);
    case PlyType::float32: return number_at<float>(at, order_);
    case PlyType::float64: break;
  }
  return number_at<double>(at, order_);
}

void PlySource::read(std::uint64_t first_byte, std::span<char> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(first_byte));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      refuse_file(name_, got < 0 ? fmt::format("cannot be read: {}", std::strerror(errno))
                                 : fmt::format("ended at byte {} while it was read", first_byte));
    first_byte += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace collided::engine
