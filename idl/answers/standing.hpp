#pragma once

#include <collided/listed_standing.hpp>

#include "idl/described.hpp"

/// Standing questions as JSON, in the order of `collide fence ls --json`.
namespace collided {

constexpr bool is_of_region(const DefinedStanding& standing) { return standing.form == StandingForm::region; }
constexpr bool is_of_bands(const DefinedStanding& standing) { return standing.form == StandingForm::bands; }
constexpr bool is_of_nearest(const DefinedStanding& standing) { return standing.form == StandingForm::nearest; }
constexpr bool has_hysteresis(const DefinedStanding& standing) { return !is_of_region(standing); }

constexpr auto fields_of(const DefinedStanding*) {
  using T = DefinedStanding;
  return listed(fields<&T::name, &T::form, &T::only, &T::skip, &T::mask, &T::keep>(),
                fields_if<is_of_region, &T::kind>(), unless_default<&T::to>(), fields_if<is_of_region, &T::detect>(),
                fields_if<is_of_bands, &T::around, &T::bands_m, &T::dwell>(), fields<&T::point>(),
                fields_if<is_of_nearest, &T::within_m>(), fields_if<has_hysteresis, &T::hysteresis_m>());
}
constexpr auto fields_of(const HeldObject*) {
  using T = HeldObject;
  return listed(fields<&T::object>(), unless_default<&T::other, &T::band_m>(), fields<&T::in_doubt, &T::since>());
}
constexpr auto fields_of(const ListedStanding*) {
  using T = ListedStanding;
  return listed(fields_of(static_cast<const DefinedStanding*>(nullptr)), fields<&T::holds>(),
                unless_default<&T::cut_short>());
}
constexpr auto fields_of(const OutlinedStanding*) {
  using T = OutlinedStanding;
  return listed(fields_of(static_cast<const DefinedStanding*>(nullptr)), fields<&T::id>(),
                fields_if<is_of_bands, &T::about, &T::band_m>(), fields<&T::holds>(), unless_default<&T::lines>());
}

}  // namespace collided
