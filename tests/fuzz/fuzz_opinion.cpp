#include <algorithm>
#include <memory>
#include <span>

#include "server/geometry/mesh.hpp"
#include "server/world/audit/opinion_request.hpp"
#include "tests/fuzz/fuzz_target.hpp"

// What is sent to collided-opinion: a request or a refusal, whatever the bytes.
namespace {

using namespace collided::engine;

void check(const OpinionRequest& request) {
  collided::fuzz::require(!request.a.empty() && !request.b.empty(), "both objects have parts");
  collided::fuzz::require(request.a.size() + request.b.size() <= kMostOpinionParts,
                          "there are no more parts than allowed");
  for (const auto* parts : {&request.a, &request.b}) {
    for (const ConvexPart& part : *parts) {
      const auto* primitive = std::get_if<Primitive>(&part);
      const auto* hull = primitive == nullptr ? nullptr : std::get_if<Hull>(primitive);
      if (hull == nullptr) continue;
      for (const TriangleCorners& face : hull->mesh->triangles) {
        const bool are_vertices =
            std::all_of(face.begin(), face.end(), [&](std::uint32_t i) { return i < hull->mesh->vertices.size(); });
        collided::fuzz::require(are_vertices, "faces name vertices");
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  const auto read = read_opinion_request(bytes);
  const auto* request = std::get_if<OpinionRequest>(&read);
  if (request == nullptr) return 0;
  check(*request);
  const std::vector<std::byte> again = encoded(*request);
  collided::fuzz::require(again.size() == size, "written again, it is as long");
  collided::fuzz::require(std::holds_alternative<OpinionRequest>(read_opinion_request(again)),
                          "written again, it is one");
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  const ConvexPart hull = Primitive(Hull{mesh});
  const ConvexPart triangle = Triangle{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<std::string> seeds;
  for (const Primitive& primitive :
       {Primitive(Sphere{{1, 2, 3}, 0.5}), Primitive(Box{.center = {0, 0, 0}, .half_m = {1, 2, 3}}),
        Primitive(Capsule{{0, 0, 0}, {1, 0, 0}, 0.1}), Primitive(Cylinder{{0, 0, 0}, {1, 0, 0}, 0.1}),
        Primitive(Cone{{0, 0, 0}, {1, 0, 0}, 0.1}), Primitive(Ellipsoid{.center = {0, 0, 0}, .half_m = {1, 2, 3}}),
        Primitive(HalfSpace{{0, 0, 0}, {0, 0, 1}})}) {
    const std::vector<std::byte> bytes = encoded({{primitive, hull}, {triangle, hull}});
    seeds.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return seeds;
}
