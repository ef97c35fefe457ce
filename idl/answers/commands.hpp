#pragma once

#include <collided/commands.hpp>

#include "idl/described.hpp"

/// The answers of commands that change or list the world, and the arguments of `load`, as JSON.
namespace collided {

constexpr auto fields_of(const Added*) {
  return listed(fields<&Added::id, &Added::version>(), unless_default<&Added::not_kept, &Added::warning>());
}
constexpr auto fields_of(const Moved*) {
  using T = Moved;
  return listed(field("moved_m", &T::distance_m), fields<&T::began, &T::ended, &T::version>(),
                unless_default<&T::not_kept>());
}
constexpr auto fields_of(const Removed*) {
  using T = Removed;
  return listed(field("removed", &T::names), field("ended", &T::contacts_ended), fields<&T::version>(),
                unless_default<&T::not_kept>());
}
constexpr auto fields_of(const Cleared*) {
  using T = Cleared;
  return listed(fields<&T::removed, &T::kept>(), field("ended", &T::contacts_ended), fields<&T::version>(),
                unless_default<&T::not_kept>());
}
/// The contacts are named `ended` or `began`, depending on the command.
constexpr auto fields_of(const RuleChanged*) {
  using T = RuleChanged;
  return listed(fields<&T::rules, &T::a_count, &T::b_count, &T::version>(), unless_default<&T::not_kept>());
}
constexpr auto fields_of(const ListedRule*) {
  using T = ListedRule;
  return fields<&T::a, &T::b, &T::because, &T::allows>();
}
constexpr auto fields_of(const Attached*) {
  return listed(fields<&Attached::parent, &Attached::version>(), unless_default<&Attached::not_kept>());
}

template <>
inline constexpr bool kIsRow<CoveredBox> = true;
constexpr auto fields_of(const CoveredBox*) { return fields<&CoveredBox::low, &CoveredBox::high>(); }
/// The word of a bool that is true.
inline constexpr const char* kSolidByWords[] = {"winding"};
/// Options that older servers may not know are written only if set.
constexpr auto fields_of(const LoadOptions*) {
  using T = LoadOptions;
  return listed(fields<&T::name>(), field("unit_m", &T::unit_m), fields<&T::up>(), field("radius_m", &T::radius_m),
                fields<&T::strict, &T::mend>(), field("crack_m", &T::crack_m), fields<&T::srdf, &T::replace>(),
                unless_default<&T::solid, &T::packages, &T::moving, &T::covers>(),
                field("solid_by", &T::solid_by_winding, kSolidByWords));
}
/// In the order of `collide load --json`.
constexpr auto fields_of(const Loaded*) {
  using T = Loaded;
  return listed(fields<&T::scene, &T::triangles, &T::parts, &T::objects, &T::seconds, &T::notes, &T::mended,
                       &T::refused, &T::warnings, &T::left_out, &T::version, &T::placed, &T::covers>(),
                unless_default<&T::not_kept>());
}

constexpr auto fields_of(const ListedObject*) {
  using T = ListedObject;
  return listed(fields<&T::name, &T::id, &T::kind, &T::moving, &T::scene, &T::publisher>(),
                fields<&T::position>(Written::or_null), fields<&T::triangles, &T::layers, &T::stale>(),
                unless_default<&T::attached_to>());
}
constexpr auto fields_of(const ObjectList*) {
  return fields<&ObjectList::objects, &ObjectList::count, &ObjectList::version>();
}
/// `get` also has bounds: [low, high] with null for an infinite side, or null if there is no triangle.
constexpr auto fields_of(const ObjectDetails*) {
  using T = ObjectDetails;
  return listed(fields_of(static_cast<const ListedObject*>(nullptr)),
                fields<&T::mask, &T::group, &T::pose, &T::age, &T::contacts, &T::solid>(),
                field("solid_by", &T::solid_by_winding, kSolidByWords));
}

constexpr auto fields_of(const PlannedStructure*) {
  using T = PlannedStructure;
  return listed(fields<&T::structure, &T::built>(), field("why", &T::reason), fields<&T::saves>());
}
constexpr auto fields_of(const PlannedPair*) { return fields<&PlannedPair::a, &PlannedPair::b, &PlannedPair::how>(); }
constexpr auto fields_of(const Wing*) { return fields<&Wing::name, &Wing::in_use>(); }
constexpr auto fields_of(const Plan*) { return fields<&Plan::structures, &Plan::pairs, &Plan::bytes, &Plan::wings>(); }

}  // namespace collided
