#include "server/exact_phase/overlap.hpp"

#include <variant>

#include "server/exact_phase/overlap_kernel.hpp"
#include "server/exact_phase/separation_filter.hpp"

namespace collided {
using kernel::climb;
using kernel::quickly_overlaps;
using kernel::sets_meet;

Verdict overlaps(const Sphere& a, const Sphere& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Sphere& a, const Box& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Sphere& a, const Capsule& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Sphere& a, const Triangle& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Box& a, const Box& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Box& a, const Capsule& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Box& a, const Triangle& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Capsule& a, const Capsule& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Capsule& a, const Triangle& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Triangle& a, const Triangle& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

Verdict overlaps(const Primitive& a, const Primitive& b) {
  return std::visit([](const auto& first, const auto& second) { return overlaps(first, second); }, a, b);
}

Verdict overlaps(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return overlaps(solid, b); }, a);
}

}  // namespace collided
