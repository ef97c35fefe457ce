#include "server/world/audit/opinion_request.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "server/geometry/mesh.hpp"

namespace collided::engine {
namespace {

constexpr std::uint64_t kFormat = 0x31'6e'6f'69'6e'69'70'6fULL;  // "opinion1"
constexpr std::uint8_t kTriangleKind = std::variant_size_v<Primitive>;

class RequestWriter {
 public:
  template <class Number>
  void put(Number number) {
    const auto* first = reinterpret_cast<const std::byte*>(&number);
    bytes_.insert(bytes_.end(), first, first + sizeof(Number));
  }
  void put_vector(const Vec3& v) {
    for (const double x : {v.x(), v.y(), v.z()}) put(x);
  }

  void write(const Sphere& s) { put_vector(s.center), put(s.radius_m); }
  void write(const Box& b) { write_axes(b.center, b.axes, b.half_m); }
  void write(const Capsule& c) { put_vector(c.a), put_vector(c.b), put(c.radius_m); }
  void write(const Cylinder& c) { put_vector(c.a), put_vector(c.b), put(c.radius_m); }
  void write(const Cone& c) { put_vector(c.apex), put_vector(c.base), put(c.radius_m); }
  void write(const Ellipsoid& e) { write_axes(e.center, e.axes, e.half_m); }
  void write(const HalfSpace& h) { put_vector(h.point), put_vector(h.normal); }
  void write(const Triangle& t) { put_vector(t.a), put_vector(t.b), put_vector(t.c); }
  void write(const Hull& hull) {
    put(static_cast<std::uint32_t>(hull.mesh->vertices.size()));
    put(static_cast<std::uint32_t>(hull.mesh->triangles.size()));
    for (const Vec3& vertex : hull.mesh->vertices) put_vector(hull.rotation * vertex + hull.position);
    for (const TriangleCorners& face : hull.mesh->triangles) {
      for (const std::uint32_t corner : face) put(corner);
    }
  }
  void write(const ConvexPart& part) {
    if (const auto* triangle = std::get_if<Triangle>(&part)) {
      put(kTriangleKind);
      write(*triangle);
      return;
    }
    const Primitive& primitive = std::get<Primitive>(part);
    put(static_cast<std::uint8_t>(primitive.index()));
    std::visit([this](const auto& shape) { write(shape); }, primitive);
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void write_axes(const Vec3& center, const Mat3& axes, const Vec3& half_m) {
    put_vector(center);
    for (int k = 0; k < 3; ++k) put_vector(axes.col(k));
    put_vector(half_m);
  }
  std::vector<std::byte> bytes_;
};

struct BadRequest : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class ReplyReader {
 public:
  explicit ReplyReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    if (bytes_.size() < sizeof(Number)) throw BadRequest("it breaks off");
    Number value;
    std::memcpy(&value, bytes_.data(), sizeof(Number));
    bytes_ = bytes_.subspan(sizeof(Number));
    return value;
  }
  double finite() {
    const double value = number<double>();
    if (!std::isfinite(value)) throw BadRequest(fmt::format("a number is {}, allowed are finite ones", value));
    return value;
  }
  double size() {
    const double value = finite();
    if (value < 0) throw BadRequest(fmt::format("a size is {}, allowed is 0 or more", value));
    return value;
  }
  Vec3 vector() {
    const double x = finite();
    const double y = finite();
    return {x, y, finite()};
  }
  Vec3 sizes() {
    const double x = size();
    const double y = size();
    return {x, y, size()};
  }
  Mat3 axes() {
    Mat3 columns;
    for (int k = 0; k < 3; ++k) columns.col(k) = vector();
    return columns;
  }
  Hull hull();
  ConvexPart part();
  std::vector<ConvexPart> parts(std::uint32_t count);
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

Hull ReplyReader::hull() {
  const auto vertex_count = number<std::uint32_t>();
  const auto face_count = number<std::uint32_t>();
  constexpr std::size_t kVertexBytes = 3 * sizeof(double);
  constexpr std::size_t kFaceBytes = 3 * sizeof(std::uint32_t);
  if (vertex_count * kVertexBytes + face_count * kFaceBytes > left()) throw BadRequest("it breaks off in a hull");
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t i = 0; i < vertex_count; ++i) mesh->vertices.push_back(vector());
  for (std::uint32_t i = 0; i < face_count; ++i) {
    TriangleCorners face{};
    for (std::uint32_t& corner : face) {
      corner = number<std::uint32_t>();
      if (corner >= vertex_count)
        throw BadRequest(fmt::format("face {} of a hull names vertex {} of {}", i, corner, vertex_count));
    }
    mesh->triangles.push_back(face);
  }
  if (vertex_count < 4 || face_count < 4)
    throw BadRequest(
        fmt::format("a hull has {} vertices and {} faces, four of each are the least", vertex_count, face_count));
  return {.mesh = std::move(mesh)};
}

ConvexPart ReplyReader::part() {
  const auto kind = number<std::uint8_t>();
  if (kind == kTriangleKind) {
    const Vec3 a = vector();
    const Vec3 b = vector();
    return Triangle{a, b, vector()};
  }
  if (kind == Primitive(Hull{}).index()) return Primitive(hull());
  const Vec3 first = vector();
  if (kind == Primitive(Sphere{}).index()) return Primitive(Sphere{first, size()});
  if (kind == Primitive(Box{}).index() || kind == Primitive(Ellipsoid{}).index()) {
    const Mat3 columns = axes();
    const Vec3 half_m = sizes();
    if (kind == Primitive(Box{}).index()) return Primitive(Box{first, columns, half_m});
    return Primitive(Ellipsoid{first, columns, half_m});
  }
  const Vec3 second = vector();
  if (kind == Primitive(HalfSpace{}).index()) return Primitive(HalfSpace{first, second});
  if (kind == Primitive(Capsule{}).index()) return Primitive(Capsule{first, second, size()});
  if (kind == Primitive(Cylinder{}).index()) return Primitive(Cylinder{first, second, size()});
  if (kind == Primitive(Cone{}).index()) return Primitive(Cone{first, second, size()});
  throw BadRequest(fmt::format("a part is of kind {}, the last one is {}", kind, kTriangleKind));
}

std::vector<ConvexPart> ReplyReader::parts(std::uint32_t count) {
  std::vector<ConvexPart> parts;
  for (std::uint32_t i = 0; i < count; ++i) parts.push_back(part());
  return parts;
}

}  // namespace

std::vector<std::byte> encoded(const OpinionRequest& request) {
  RequestWriter writer;
  writer.put(kFormat);
  writer.put(static_cast<std::uint32_t>(request.a.size()));
  writer.put(static_cast<std::uint32_t>(request.b.size()));
  for (const auto* parts : {&request.a, &request.b}) {
    for (const ConvexPart& part : *parts) writer.write(part);
  }
  return writer.take();
}

std::variant<OpinionRequest, std::string> read_opinion_request(std::span<const std::byte> bytes) {
  try {
    if (bytes.size() > kMostOpinionBytes)
      throw BadRequest(fmt::format("{} bytes, allowed {}", bytes.size(), kMostOpinionBytes));
    ReplyReader reader(bytes);
    if (reader.number<std::uint64_t>() != kFormat) throw BadRequest("it does not begin as one");
    const auto a_count = reader.number<std::uint32_t>();
    const auto b_count = reader.number<std::uint32_t>();
    if (a_count == 0 || b_count == 0 || std::uint64_t{a_count} + b_count > kMostOpinionParts) {
      throw BadRequest(
          fmt::format("{} and {} parts, allowed are one of each and {} together", a_count, b_count, kMostOpinionParts));
    }
    OpinionRequest request;
    request.a = reader.parts(a_count);
    request.b = reader.parts(b_count);
    if (reader.left() > 0) throw BadRequest(fmt::format("{} bytes are left over", reader.left()));
    return request;
  } catch (const BadRequest& bad) {
    return fmt::format("the request for an opinion is none: {}; nothing was asked", bad.what());
  }
}

}  // namespace collided::engine
