#include "server/world/sweep.hpp"

#include <variant>

#include "server/exact_phase/general_shapes.hpp"
#include "server/exact_phase/contact.hpp"

namespace collided {
namespace {

template <class Part>
void sweep_any(Sweep& sweep, const Part& part, std::uint32_t triangle) {
  TimeBracket bracket;
  const Verdict verdict = first_contact(sweep.mover, part, sweep.width, bracket);
  ++sweep.exact_tests;
  if (verdict.decision == Decision::undecided) sweep.undecided = true;
  if (!verdict.yes()) return;
  const bool earlier = !sweep.yes || bracket.high < sweep.bracket.high ||
                       (bracket.high == sweep.bracket.high && triangle < sweep.triangle);
  if (!earlier) {
    // A later one may still have the lower beginning: the bracket holds the first contact of all.
    sweep.bracket.low = std::min(sweep.bracket.low, bracket.low);
    return;
  }
  const double low = sweep.yes ? std::min(sweep.bracket.low, bracket.low) : bracket.low;
  sweep.yes = true;
  sweep.bracket = {.low = low, .high = bracket.high};
  sweep.triangle = triangle;
  const Vec3 center = sweep.mover.start + bracket.high * (sweep.mover.end - sweep.mover.start);
  sweep.contact = contact(Sphere{.center = center, .radius_m = sweep.mover.radius_m}, part);
}

}  // namespace

std::optional<Sphere> lone_sphere(const ObjectInfo& info) {
  if (info.mesh || info.primitives.size() != 1) return std::nullopt;
  const Sphere* sphere = std::get_if<Sphere>(&info.primitives.front());
  return sphere != nullptr ? std::optional(*sphere) : std::nullopt;
}

Aabb bounds(const MovingSphere& mover) {
  return bounds(Capsule{.a = mover.start, .b = mover.end, .radius_m = mover.radius_m});
}

void sweep_part(Sweep& sweep, const Triangle& part, std::uint32_t triangle) { sweep_any(sweep, part, triangle); }

void sweep_object(Sweep& sweep, const Placed& other, WalkCost& cost) {
  visit_primitives_near(*other.info, *other.frame, bounds(sweep.mover), cost, [&](const Primitive& primitive) {
    std::visit([&](const auto& part) { sweep_any(sweep, place(*other.frame, part), wire_contract::kNoTriangle); },
               primitive);
    return true;
  });
  if (!other.info->mesh) return;
  struct Context {
    Sweep& sweep;
    const Placed& other;
  } context{sweep, other};
  const auto candidate = [](void* raw, std::uint32_t triangle) {
    Context& c = *static_cast<Context*>(raw);
    sweep_any(c.sweep, place(*c.other.frame, c.other.info->mesh->mesh->triangle(triangle)), triangle);
    return true;
  };
  const IndexedMesh& mesh = *other.info->mesh;
  mesh.tree.walk_box(seen_from(*other.frame, bounds(sweep.mover), mesh.radius_m), candidate, &context, cost);
}

}  // namespace collided
