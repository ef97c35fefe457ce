#pragma once

#include <tuple>

#include <collided/clearance.hpp>
#include <collided/pair.hpp>

#include "idl/described.hpp"

/// The answers of the commands `pair` and `clearance` as JSON.
namespace collided {

template <>
inline constexpr const char* kWordsOf<Containment>[] = {"", "a", "b"};
template <>
inline constexpr const char* kWordsOf<CertifiedPart::Summand>[] = {"nothing",   "ball", "box",
                                                                   "ellipsoid", "disc", "half_space"};
template <>
inline constexpr const char* kWordsOf<Certificate::Step::Kind>[] = {"plane", "split_a", "split_b"};

// ---- certificates --------------------------------------------------------------------------------------------------

template <CertifiedPart::Summand... kOf>
constexpr bool is_any_of(const CertifiedPart& part) {
  return ((part.summand == kOf) || ...);
}
constexpr auto fields_of(const CertifiedPart*) {
  using T = CertifiedPart;
  using enum CertifiedPart::Summand;
  constexpr auto has_axes = is_any_of<box, ellipsoid, half_space>;
  return listed(field("beside", &T::summand), fields<&T::points>(), unless_default<&T::triangle>(),
                fields_if<has_axes, &T::axes>(), field_if<has_axes>("half_m", &T::half_m),
                field_if<is_any_of<ball, disc>>("radius_m", &T::radius_m), fields_if<is_any_of<disc>, &T::tapers>());
}

template <Certificate::Step::Kind kOf>
constexpr bool is_step(const Certificate::Step& step) {
  return step.kind == kOf;
}
constexpr auto fields_of(const Certificate::Step*) {
  using T = Certificate::Step;
  constexpr auto is_plane = is_step<T::Kind::plane>;
  return listed(fields<&T::kind>(), fields_if<is_plane, &T::normal, &T::point>(), unless_default<&T::at>());
}

constexpr auto fields_of(const Certificate*) {
  using T = Certificate;
  constexpr auto is_apart = [](const T& certificate) { return !certificate.touches; };
  return listed(fields<&T::touches, &T::a, &T::b>(),
                fields_if<&T::touches, &T::point, &T::divisor, &T::mix_a, &T::mix_b>(),
                fields_if<is_apart, &T::steps>());
}

// ---- two objects ---------------------------------------------------------------------------------------------------

template <>
inline constexpr bool kIsRow<ManifoldPoint> = true;
constexpr auto fields_of(const ManifoldPoint*) {
  using T = ManifoldPoint;
  return fields<&T::point, &T::depth_m, &T::error_m, &T::a_triangle, &T::b_triangle>();
}
template <>
inline constexpr bool kIsRow<TrianglePair> = true;
constexpr auto fields_of(const TrianglePair*) {
  using T = TrianglePair;
  return fields<&T::a_triangle, &T::b_triangle, &T::from, &T::to, &T::error_m>();
}

constexpr auto fields_of(const SecondOpinion*) {
  using T = SecondOpinion;
  return listed(fields<&T::verdict, &T::touches, &T::distance_m>(), unless_default<&T::why>());
}

constexpr auto fields_of(const PairAnswer*) {
  using T = PairAnswer;
  constexpr auto touches = [](const T& pair) { return pair.verdict == Verdict::hit; };
  constexpr auto is_apart = [](const T& pair) { return pair.verdict == Verdict::miss; };
  constexpr auto is_decided = [](const T& pair) { return pair.verdict != Verdict::undecided; };
  constexpr auto has_depth = [](const T& pair) { return pair.verdict == Verdict::hit || pair.is_in_solid; };
  return listed(field("answer", &T::verdict), unless_default<&T::reason>(),
                field("in_solid", &T::is_in_solid, Written::unless_default), fields_if<has_depth, &T::depth_m>(),
                fields_if<&T::is_in_solid, &T::depth_error_m>(), fields_if<is_apart, &T::distance_m>(),
                fields_if<is_decided, &T::error_m, &T::normal>(),
                fields_if<touches, &T::point, &T::a_triangle, &T::b_triangle, &T::manifold>(),
                fields_if<is_apart, &T::on_a, &T::on_b, &T::point_error_m>(), fields_if<is_apart, &T::contained>(),
                unless_default<&T::stale, &T::triangle_pairs>(),
                field("pair_count", &T::triangle_pair_count, Written::unless_default), unless_default<&T::cut>(),
                fields<&T::certificate>(), unless_default<&T::no_certificate>(), fields<&T::opinion, &T::version>());
}

// ---- two groups ----------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ClearancePair*) {
  using T = ClearancePair;
  return listed(fields<&T::a, &T::b, &T::a_id, &T::b_id>(), field("answer", &T::verdict),
                fields<&T::clearance_m, &T::error_m>(), fields<&T::contained>(),
                fields<&T::on_a, &T::on_b, &T::point_error_m, &T::normal, &T::a_triangle, &T::b_triangle>(),
                unless_default<&T::stale>(), fields<&T::certificate>(), unless_default<&T::no_certificate>());
}

constexpr auto fields_of(const ClearanceAnswer*) {
  using T = ClearanceAnswer;
  return listed(field("answer", &T::verdict), unless_default<&T::reason>(),
                fields<&T::pairs, &T::from_count, &T::to_count, &T::filtered, &T::tested>(),
                unless_default<&T::cut, &T::late>(), fields<&T::uncovered>(), unless_default<&T::stale>(),
                fields<&T::version>());
}

}  // namespace collided
