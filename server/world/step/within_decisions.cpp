// Declared solids: an object inside one touches it, though their surfaces do not meet.

#include <algorithm>
#include <utility>

#include "server/world/solids/within.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {
namespace {

/// Adds the contact of an inner object to a search in which it is b, or a if `is_turned`.
void take_within(const ContactWithin& found, bool is_turned, ContactSearch& touch) {
  touch.contact = found.contact;
  touch.a_triangle = touch.b_triangle = kNoTriangle;
  (is_turned ? touch.b_triangle : touch.a_triangle) = found.triangle;
  if (is_turned) touch.contact.normal = -touch.contact.normal;
}

}  // namespace

/// Adds containment in a solid to a search that found no meeting surfaces. True: the whole inner object lies inside.
bool Decisions::look_in(const Placed& outer, const Placed& inner, std::span<const Vec3> points, bool is_turned,
                        ContactSearch& touch) {
  if (touch.yes || !overlaps(outer.bounds, inner.bounds)) return false;
  Deadline never;
  const SolidMesh& solid = *outer.info->rare->solid;
  const PiecesWithin found = pieces_within(solid, outer, inner, points, never, walk_, cost_.exact_tests);
  if (!found.some) return false;
  touch.yes = true;
  if (touch.wanted)
    take_within(contact_within(solid, outer, inner, found.point, walk_, cost_.exact_tests), is_turned, touch);
  return found.all && !touch.undecided;
}

Contained Decisions::look_within(const Placed& a, const Placed& b, ContactSearch& touch) {
  if (touch.yes) return Contained::none;
  if (a.info->rare->solid && look_in(a, b, lists_.pieces.of(*b.info), false, touch)) return Contained::b_in_a;
  if (b.info->rare->solid && look_in(b, a, lists_.pieces.of(*a.info), true, touch)) return Contained::a_in_b;
  return Contained::none;
}

/// Adds to part_touches the parts of the scene that contain the mover, and those that it contains.
void Decisions::look_within_scene(const Placed& a, const StaticScene& scene) {
  lists_.parts_within.clear();
  for (const SolidPart& part : scene.solid_parts) {
    if (!overlaps(a.bounds, part.bounds)) continue;
    Placed outer = placed(slot_of(scene.part_objects[part.part]));
    outer.bounds = part.bounds;
    look_within_part(a, scene, part.part, [&](ContactSearch& touch) {
      return look_in(outer, a, lists_.pieces.of(*a.info), true, touch) ? Contained::a_in_b : Contained::none;
    });
  }
  if (!a.info->rare->solid) return;
  for (std::uint32_t part = 0; part < scene.parts.size(); ++part) {
    const PiecePoints::PartPoints& pieces = lists_.pieces.of(scene, part);
    if (!overlaps(a.bounds, pieces.bounds)) continue;
    Placed inner = placed(slot_of(scene.part_objects[part]));
    inner.bounds = pieces.bounds;
    look_within_part(a, scene, part, [&](ContactSearch& touch) {
      return look_in(a, inner, pieces.points, false, touch) ? Contained::b_in_a : Contained::none;
    });
  }
}

void Decisions::look_within_part(const Placed& a, const StaticScene& scene, std::uint32_t part,
                                 FunctionRef<Contained(ContactSearch& touch)> look) {
  if (!may_meet(a.info->filter, scene.parts[part].filter)) return;
  const std::vector<PartContact>& touched = lists_.part_touches.list();
  const auto known = std::find_if(touched.begin(), touched.end(), [&](const PartContact& t) { return t.part == part; });
  ContactSearch touch;
  touch.wanted = step_.step_options.contacts;
  if (known != touched.end()) touch = known->touch;
  if (touch.yes) return;
  const Contained contained = look(touch);
  if (!touch.yes) return;
  lists_.part_touches.of(part) = touch;
  lists_.parts_within.push_back({part, contained});
}

/// For a mover and a part whose surfaces do not touch: which lies within the other; a is the mover.
Contained Decisions::look_within_part_at(const Placed& a, const StaticScene& scene, std::uint32_t part,
                                         ContactSearch& touch) {
  Placed other = placed(slot_of(scene.part_objects[part]));
  if (other.info->rare->solid && look_in(other, a, lists_.pieces.of(*a.info), true, touch)) return Contained::a_in_b;
  if (touch.yes || !a.info->rare->solid) return Contained::none;
  const PiecePoints::PartPoints& pieces = lists_.pieces.of(scene, part);
  other.bounds = pieces.bounds;
  return look_in(a, other, pieces.points, false, touch) ? Contained::b_in_a : Contained::none;
}

/// For a continuing contact on common time: when one of the two came to lie within the other, which is when their
/// surfaces separated, or when it no longer did.
void Decisions::set_change_of_containment(const PairPiece& piece, FoundContact& found) {
  const Contained before = ledger_.contained(found.a, found.b);
  if (before == found.contained) return;
  const ContactEnd change = before == Contained::none ? parting(piece) : emerging(piece);
  found.bracket_low_s = change.bracket_low_s;
  found.bracket_high_s = change.bracket_high_s;
}

/// When one that lay within the other no longer did: when their surfaces first met.
ContactEnd Decisions::emerging(const PairPiece& piece) {
  const SweptContact first = sweep_piece(piece);
  const PieceBracket met = in_seconds(piece, first.yes ? first.bracket : TimeBracket{0, 1}, first.contact);
  return {.reason = EndReason::separated, .bracket_low_s = met.low_s, .bracket_high_s = met.high_s};
}

}  // namespace collided::engine
