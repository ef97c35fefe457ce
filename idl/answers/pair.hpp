#pragma once

#include <tuple>

#include <collided/clearance.hpp>
#include <collided/pair.hpp>

#include "idl/described.hpp"

/// The answers of the commands `pair` and `clearance` as JSON.
namespace collided {

inline constexpr const char* kContainmentWords[] = {"", "a", "b"};
inline constexpr const char* kSummandWords[] = {"nothing", "ball", "box", "ellipsoid", "disc", "half_space"};

// ---- certificates --------------------------------------------------------------------------------------------------

template <CertifiedPart::Summand... kOf>
constexpr bool is_any_of(const CertifiedPart& part) {
  return ((part.summand == kOf) || ...);
}
constexpr auto fields_of(const CertifiedPart*) {
  using T = CertifiedPart;
  using enum CertifiedPart::Summand;
  constexpr auto has_axes = is_any_of<box, ellipsoid, half_space>;
  return std::tuple(field("beside", &T::summand, kSummandWords), field("points", &T::points),
                    field("triangle", &T::triangle, Written::unless_default), field_if<has_axes>("axes", &T::axes),
                    field_if<has_axes>("half_m", &T::half_m), field_if<is_any_of<ball, disc>>("radius_m", &T::radius_m),
                    field_if<is_any_of<disc>>("tapers", &T::tapers));
}

template <Certificate::Step::Kind kOf>
constexpr bool is_step(const Certificate::Step& step) {
  return step.kind == kOf;
}
inline constexpr const char* kStepWords[] = {"plane", "split_a", "split_b"};
constexpr auto fields_of(const Certificate::Step*) {
  using T = Certificate::Step;
  constexpr auto is_plane = is_step<T::Kind::plane>;
  return std::tuple(field("kind", &T::kind, kStepWords), field_if<is_plane>("normal", &T::normal),
                    field_if<is_plane>("point", &T::point), field("at", &T::at, Written::unless_default));
}

constexpr auto fields_of(const Certificate*) {
  using T = Certificate;
  constexpr auto is_apart = [](const T& certificate) { return !certificate.touches; };
  return std::tuple(field("touches", &T::touches), field("a", &T::a), field("b", &T::b),
                    field_if<&T::touches>("point", &T::point), field_if<&T::touches>("divisor", &T::divisor),
                    field_if<&T::touches>("mix_a", &T::mix_a), field_if<&T::touches>("mix_b", &T::mix_b),
                    field_if<is_apart>("steps", &T::steps));
}

// ---- two objects ---------------------------------------------------------------------------------------------------

template <>
inline constexpr bool kIsRow<ManifoldPoint> = true;
constexpr auto fields_of(const ManifoldPoint*) {
  using T = ManifoldPoint;
  return std::tuple(field("point", &T::point), field("depth", &T::depth_m), field("error", &T::error_m),
                    field("a_triangle", &T::a_triangle), field("b_triangle", &T::b_triangle));
}
template <>
inline constexpr bool kIsRow<TrianglePair> = true;
constexpr auto fields_of(const TrianglePair*) {
  using T = TrianglePair;
  return std::tuple(field("a_triangle", &T::a_triangle), field("b_triangle", &T::b_triangle), field("from", &T::from),
                    field("to", &T::to), field("error", &T::error_m));
}

constexpr auto fields_of(const SecondOpinion*) {
  using T = SecondOpinion;
  return std::tuple(field("verdict", &T::verdict), field("touches", &T::touches), field("distance", &T::distance_m),
                    field("why", &T::why, Written::unless_default));
}

constexpr auto fields_of(const PairAnswer*) {
  using T = PairAnswer;
  constexpr auto touches = [](const T& pair) { return pair.verdict == Verdict::hit; };
  constexpr auto is_apart = [](const T& pair) { return pair.verdict == Verdict::miss; };
  constexpr auto is_decided = [](const T& pair) { return pair.verdict != Verdict::undecided; };
  constexpr auto has_depth = [](const T& pair) { return pair.verdict == Verdict::hit || pair.is_in_solid; };
  return std::tuple(field("answer", &T::verdict), field("reason", &T::reason, Written::unless_default),
                    field("in_solid", &T::is_in_solid, Written::unless_default),
                    field_if<has_depth>("depth", &T::depth_m),
                    field_if<&T::is_in_solid>("depth_error", &T::depth_error_m),
                    field_if<is_apart>("distance", &T::distance_m), field_if<is_decided>("error", &T::error_m),
                    field_if<is_decided>("normal", &T::normal), field_if<touches>("point", &T::point),
                    field_if<touches>("a_triangle", &T::a_triangle), field_if<touches>("b_triangle", &T::b_triangle),
                    field_if<touches>("manifold", &T::manifold), field_if<is_apart>("on_a", &T::on_a),
                    field_if<is_apart>("on_b", &T::on_b), field_if<is_apart>("point_error", &T::point_error_m),
                    field_if<is_apart>("contained", &T::contained, kContainmentWords),
                    field("stale", &T::stale, Written::unless_default),
                    field("triangle_pairs", &T::triangle_pairs, Written::unless_default),
                    field("pair_count", &T::triangle_pair_count, Written::unless_default),
                    field("cut", &T::cut, Written::unless_default), field("certificate", &T::certificate),
                    field("no_certificate", &T::no_certificate, Written::unless_default), field("opinion", &T::opinion),
                    field("version", &T::version));
}

// ---- two groups ----------------------------------------------------------------------------------------------------

constexpr auto fields_of(const ClearancePair*) {
  using T = ClearancePair;
  return std::tuple(field("a", &T::a), field("b", &T::b), field("a_id", &T::a_id), field("b_id", &T::b_id),
                    field("answer", &T::verdict), field("clearance", &T::clearance_m), field("error", &T::error_m),
                    field("contained", &T::contained, kContainmentWords), field("on_a", &T::on_a),
                    field("on_b", &T::on_b), field("point_error", &T::point_error_m), field("normal", &T::normal),
                    field("a_triangle", &T::a_triangle), field("b_triangle", &T::b_triangle),
                    field("stale", &T::stale, Written::unless_default), field("certificate", &T::certificate),
                    field("no_certificate", &T::no_certificate, Written::unless_default));
}

constexpr auto fields_of(const ClearanceAnswer*) {
  using T = ClearanceAnswer;
  return std::tuple(field("answer", &T::verdict), field("reason", &T::reason, Written::unless_default),
                    field("pairs", &T::pairs), field("from_count", &T::from_count), field("to_count", &T::to_count),
                    field("filtered", &T::filtered), field("tested", &T::tested),
                    field("cut", &T::cut, Written::unless_default), field("late", &T::late, Written::unless_default),
                    field("uncovered", &T::uncovered), field("stale", &T::stale, Written::unless_default),
                    field("version", &T::version));
}

}  // namespace collided
