#include "server/exact_phase/given/margin.hpp"

#include <optional>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// The points within by_m of the shape, or slightly more. by_m < 0: points at least -by_m inside the shape. Nothing if
/// the set is empty or has no known form.
std::optional<Primitive> grown(const Primitive& shape, double by_m) {
  // The sum's rounding goes in the direction of by_m too; a box's axes are orthonormal up to less than kChainSlack.
  const auto resized = [&](double size_m) {
    return (size_m + by_m * (1 + kChainSlack)) * (by_m > 0 ? 1 + 2 * kRoundoff : 1 - 2 * kRoundoff);
  };
  return std::visit(
      [&](const auto& s) -> std::optional<Primitive> {
        using Shape = std::decay_t<decltype(s)>;
        Shape result = s;
        if constexpr (std::is_same_v<Shape, Sphere> || std::is_same_v<Shape, Capsule>) {
          result.radius_m = resized(s.radius_m);
          if (!(result.radius_m >= 0)) return std::nullopt;
        } else if constexpr (std::is_same_v<Shape, Box>) {
          for (double& half_m : result.half_m) {
            half_m = resized(half_m);
            if (!(half_m >= 0)) return std::nullopt;
          }
        } else {
          return std::nullopt;
        }
        return result;
      },
      shape);
}

/// A pair with one of the two grown; nothing if neither can be.
std::optional<Decision> overlaps_grown(const ConvexPart& a, const ConvexPart& b, double by_m) {
  for (const auto& [resized, other] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const auto* primitive = std::get_if<Primitive>(resized);
    if (primitive == nullptr) continue;
    if (const std::optional<Primitive> shape = grown(*primitive, by_m))
      return overlaps(ConvexPart(*shape), *other).decision;
  }
  return std::nullopt;
}

}  // namespace

bool surely_apart(const Triangle& a, const Triangle& b, double off_m) {
  return kernel::quickly_overlaps(a, b, off_m) == Decision::no;
}

bool surely_apart(const ConvexPart& a, const ConvexPart& b, double off_m) {
  const auto* first = std::get_if<Triangle>(&a);
  const auto* second = std::get_if<Triangle>(&b);
  if (first != nullptr && second != nullptr && surely_apart(*first, *second, off_m)) return true;
  if (const std::optional<Decision> grown = overlaps_grown(a, b, off_m)) return *grown == Decision::no;
  if (overlaps(a, b).decision != Decision::no) return false;
  const Separation apart = separation(a, b);
  return apart.distance_m - apart.error_m > off_m;
}

bool surely_meet(const ConvexPart& a, const ConvexPart& b, double off_m) {
  const auto* first = std::get_if<Triangle>(&a);
  const auto* second = std::get_if<Triangle>(&b);
  if (first != nullptr && second != nullptr) {
    const Decision quick = kernel::quickly_overlaps(*first, *second, off_m);
    if (quick != Decision::undecided) return quick == Decision::yes;
  }
  if (const std::optional<Decision> shrunk = overlaps_grown(a, b, -off_m)) return *shrunk == Decision::yes;
  if (!overlaps(a, b).yes()) return false;
  const Contact deepest = contact(a, b);
  return deepest.depth_m - deepest.depth_error_m > off_m;
}

}  // namespace collided::engine
