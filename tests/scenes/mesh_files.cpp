#include "tests/scenes/mesh_files.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace collided::scenes {
using namespace engine;
namespace {

template <class Number>
void put(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string obj_file(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v[0], v[1], v[2]);
  for (const TriangleCorners& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string off_file(const TriangleMesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) text += fmt::format("{:.9g} {:.9g} {:.9g}\n", v[0], v[1], v[2]);
  for (const TriangleCorners& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string stl_file(const TriangleMesh& mesh) {
  std::string bytes(80, '\0');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    for (int k = 0; k < 3; ++k) put(bytes, 0.f);
    for (const Vec3& corner : {t.a, t.b, t.c}) {
      for (const double number : corner) put(bytes, static_cast<float>(number));
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply_file(const TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double "
      "z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) {
    for (const double number : v) put(bytes, number);
  }
  for (const TriangleCorners& t : mesh.triangles) {
    put(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : t) put(bytes, static_cast<std::int32_t>(corner));
  }
  return bytes;
}

}  // namespace collided::scenes
