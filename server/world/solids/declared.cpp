#include "server/world/solids/declared.hpp"

#include <unordered_map>

#include "idl/clocks.hpp"
#include "idl/glob.hpp"
#include "server/intake/weld.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/solids/winding.hpp"

namespace collided::engine {
namespace {

using wire_contract::glob_matches;

/// The part's triangles as a mesh of their own, in the same order.
std::shared_ptr<const TriangleMesh> mesh_of(const StaticScene& geometry, const Part& part) {
  auto mesh = std::make_shared<TriangleMesh>();
  std::unordered_map<std::uint32_t, std::uint32_t> own;
  for (std::uint32_t i = 0; i < part.triangle_count; ++i) {
    TriangleCorners corners = geometry.mesh.triangles[part.first_triangle + i];
    for (std::uint32_t& corner : corners) {
      const auto [at, is_new] = own.try_emplace(corner, static_cast<std::uint32_t>(mesh->vertices.size()));
      if (is_new) mesh->vertices.push_back(geometry.mesh.vertices[corner]);
      corner = at->second;
    }
    mesh->triangles.push_back(corners);
  }
  return mesh;
}

/// The caveats for a mesh that is solid by winding number.
std::string winding_warning(const std::string& refusal) {
  return "solid by winding number, since " + refusal +
         "; that decides inside and near --signed alone: overlaps, pairs, rays and events take it as a surface";
}

void note(const std::string& name, const SolidFindings& findings, bool is_by_winding, DeclaredSolids& declared) {
  if (is_by_winding) {
    ++declared.by_winding;
    declared.warnings.push_back(name + " is " + winding_warning(findings.refusal));
    return;
  }
  if (!findings.refusal.empty()) {
    declared.refused.push_back(name + " is not solid, and stays a surface: " + findings.refusal);
    return;
  }
  ++declared.count;
  if (findings.warning.empty()) return;
  declared.warnings.push_back(name + ": " + findings.warning +
                              "; inside is where it goes around a point, and depths are lower bounds");
}

}  // namespace

DeclaredMesh declare_solid_at_once(const std::shared_ptr<const TriangleMesh>& mesh, SolidBy by) {
  constexpr std::int64_t kPatienceNs = 200'000'000;
  const std::int64_t until_ns = wire_contract::steady_ns() + kPatienceNs;
  DeclaredMesh declared;
  declared.indexed = indexed_mesh(mesh, Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
  SolidFindings findings;
  declared.solid = solid_within(declared.indexed, findings, [&] { return wire_contract::steady_ns() > until_ns; });
  declared.refusal = std::move(findings.refusal);
  declared.warning = std::move(findings.warning);
  if (declared.solid || by != SolidBy::winding) return declared;
  declared.winding = winding_within(declared.indexed);
  declared.warning = winding_warning(declared.refusal);
  return declared;
}

DeclaredSolids declare_solids(const Scene& scene, StaticScene& geometry, std::string_view glob,
                              const std::function<bool()>& cancelled, SolidBy by) {
  DeclaredSolids declared;
  const auto is_cancelled = [&] { return cancelled && cancelled(); };
  const auto asked = [&](const auto& member) {
    return glob_matches(glob, member.name) ? std::optional(by) : member.solid;
  };
  for (std::uint32_t i = 0; i < geometry.parts.size() && !is_cancelled(); ++i) {
    const Part& part = geometry.parts[i];
    const std::optional<SolidBy> part_by = asked(part);
    if (part.triangle_count == 0 || !part_by) continue;
    const auto mesh = mesh_of(geometry, part);
    const auto surface = indexed_mesh(mesh, Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = cancelled}));
    SolidFindings findings;
    const auto solid = solid_within(surface, findings, cancelled);
    const bool is_by_winding = !solid && *part_by == SolidBy::winding;
    note(part.name, findings, is_by_winding, declared);
    if (solid) geometry.solid_parts.push_back({i, surface->tree.bounds(), solid});
    if (is_by_winding) geometry.winding_parts.push_back({i, surface->tree.bounds(), winding_within(surface)});
  }
  geometry.object_solids.resize(geometry.object_meshes.size());
  geometry.object_windings.resize(geometry.object_meshes.size());
  // Objects that share a mesh share its solid.
  struct Found {
    std::shared_ptr<const SolidMesh> solid;
    std::shared_ptr<const WindingMesh> winding;
    SolidFindings findings;
  };
  std::unordered_map<const IndexedMesh*, Found> of_mesh;
  for (std::size_t i = 0; i < geometry.object_meshes.size() && !is_cancelled(); ++i) {
    const std::shared_ptr<const IndexedMesh>& surface = geometry.object_meshes[i];
    const std::optional<SolidBy> object_by = asked(scene.objects[i]);
    if (!surface || !object_by) continue;
    const auto [known, is_new] = of_mesh.try_emplace(surface.get());
    auto& [solid, winding, findings] = known->second;
    if (is_new) solid = solid_within(surface, findings, cancelled);
    const bool is_by_winding = !solid && *object_by == SolidBy::winding;
    if (is_by_winding && !winding) winding = winding_within(surface);
    note(scene.objects[i].name, findings, is_by_winding, declared);
    geometry.object_solids[i] = solid;
    if (is_by_winding) geometry.object_windings[i] = winding;
  }
  return declared;
}

}  // namespace collided::engine
