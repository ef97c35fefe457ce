#include <algorithm>
#include <cmath>

#include "client/library/commands/geometry_decoding.hpp"
#include "idl/geometry_generated.h"
#include "idl/topics.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using namespace collided;
using fuzz::require;

void check(const Pose& pose) {
  require(pose.position.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-5, "a pose is one");
}

void check(const client::DecodedObjects& decoded, std::size_t byte_count) {
  require(decoded.runs.size() == decoded.shown.objects.size(), "runs are one list an object");
  std::size_t parts = 0;
  for (const ShownObject& object : decoded.shown.objects) {
    check(object.pose);
    require(object.name.size() <= wire_contract::kMaxNameBytes, "names have their limit");
    parts += object.parts.size();
  }
  require(parts * sizeof(double) <= byte_count && decoded.shown.objects.size() * 64 <= byte_count,
          "nothing grows out of nothing");
}

void check(const Surface& surface) {
  for (const Vec3& vertex : surface.vertices) require(vertex.allFinite(), "vertices are finite");
  for (const auto& corners : surface.triangles) {
    require(*std::max_element(corners.begin(), corners.end()) < surface.vertices.size(), "corners are vertices");
  }
  for (const SurfaceEdge& edge : surface.edges) {
    require(std::max(edge.ends[0], edge.ends[1]) < surface.vertices.size(), "edges end at vertices");
    require(edge.triangles[0] < surface.triangles.size(), "edges are of triangles");
    require(edge.triangles[1] < surface.triangles.size() || edge.triangles[1] == kNoTriangle,
            "edges are of two triangles");
  }
}

template <class Root>
std::string finished(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Root> root) {
  builder.Finish(root);
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

std::string two_objects() {
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<format::Sphere> spheres{{format::Vec3(1, 2, 3), 0.5}, {format::Vec3(0, 0, 0), 1}};
  const std::vector<format::Box> boxes{{format::Vec3(0, 0, 0), format::Quat(1, 0, 0, 0), format::Vec3(1, 2, 3)}};
  const std::vector<format::Mat3> axes{{format::Vec3(0, 1, 0), format::Vec3(1, 0, 0), format::Vec3(0, 0, 1)}};
  const std::vector<format::Ellipsoid> ellipsoids{{format::Vec3(0, 0, 1), axes[0], format::Vec3(1, 2, 3)}};
  const std::vector<format::Run> runs{{7, 0, 2, false}, {9, 1, 3, true}};
  const format::Vec3 position(4, 5, 6);
  const format::Quat rotation(0.6, 0, 0.8, 0);
  const format::Filter filter(1, 2, 3);
  const auto sphere_vector = builder.CreateVectorOfStructs(spheres);
  const auto box_vector = builder.CreateVectorOfStructs(boxes);
  const auto axes_vector = builder.CreateVectorOfStructs(axes);
  const auto ellipsoid_vector = builder.CreateVectorOfStructs(ellipsoids);
  format::ShapeBuilder shape(builder);
  shape.add_spheres(sphere_vector);
  shape.add_boxes(box_vector);
  shape.add_box_axes(axes_vector);
  shape.add_ellipsoids(ellipsoid_vector);
  const auto solids = shape.Finish();
  const auto one =
      format::CreateShownObjectDirect(builder, 1, "crate", "", true, false, &filter, &position, &rotation, solids);
  const auto two = format::CreateShownObjectDirect(builder, 2, "hall/wall", "hall", false, true, &filter, &position,
                                                   &rotation, 0, &runs);
  return finished(builder,
                  format::CreateShownObjects(builder, 1, 2, 3, 4, builder.CreateVector(std::vector{one, two})));
}

std::string surface() {
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<double> numbers{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
  const std::vector<std::uint32_t> edges{0, 1, 0, kNoTriangle, 0, 2, 0, 1, 2, 3, 1, kNoTriangle};
  const std::vector<std::uint8_t> kinds{kBoundaryEdge, kCreaseEdge, kBoundaryEdge};
  const auto mesh = format::CreateMeshDirect(builder, &numbers, &corners);
  return finished(builder, format::CreateSurfaceDirect(builder, mesh, &edges, &kinds));
}

std::string poses() {
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<std::uint64_t> ids{1, 2};
  const std::vector<double> numbers{0, 1, 2, 1, 0, 0, 0, 3, 4, 5, 0.6, 0.8, 0, 0};
  const std::vector<std::uint8_t> stale{0, 1};
  return finished(builder, format::CreatePosesDirect(builder, 1, 2, 3, 4, &ids, &numbers, &stale));
}

std::string page() {
  flatbuffers::FlatBufferBuilder builder;
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4, 5};
  return finished(builder, format::CreatePageDirect(builder, 6, 100, 95, &bytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::string flaw;
  if (const auto objects = client::decode_objects(text, flaw)) check(*objects, size);
  if (const auto mesh = client::decode_surface(text, flaw)) check(*mesh);
  if (const auto decoded = client::decode_page(text, flaw)) {
    require(decoded->bytes.empty() || (decoded->bytes.data() >= text.data() &&
                                       decoded->bytes.data() + decoded->bytes.size() <= text.data() + size),
            "a page's bytes are in its text");
  }
  if (const auto decoded = client::decode_poses(text, flaw)) {
    require(decoded->ids.size() == decoded->poses.size() && decoded->ids.size() == decoded->stale.size(),
            "columns are parallel");
    for (const Pose& pose : decoded->poses) check(pose);
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  // Each is what one of the decoders takes.
  std::string flaw;
  require(client::decode_objects(two_objects(), flaw).has_value() &&
              client::decode_surface(surface(), flaw).has_value() && client::decode_poses(poses(), flaw).has_value() &&
              client::decode_page(page(), flaw).has_value(),
          "whole buffers are taken");
  return {two_objects(), surface(), poses(), page()};
}
