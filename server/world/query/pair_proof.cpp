// Certificates that two objects touch or are separate, which a reader can check without trusting the engine.

#include <algorithm>
#include <cmath>
#include <span>

#include "server/geometry/guess_tolerance.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine {
namespace {

/// A range of one object's parts; the search sorts them once and then splits ranges by number.
using Range = std::span<ProofPart>;

/// The middle of a part's bounds.
Vec3 middle_of(const ConvexPart& part) {
  const Aabb box = bounds_of_part(part);
  return box.low / 2 + box.high / 2;
}

Aabb bounds_of_range(const Range& parts) {
  Aabb all;
  for (const ProofPart& part : parts) all.extend(bounds_of_part(part.part));
  return all;
}

/// The point of a range that lies farthest along n.
Vec3 support_of(const Range& parts, const Vec3& n) {
  Vec3 best = Vec3::Zero();
  double most = -std::numeric_limits<double>::infinity();
  for (const ProofPart& part : parts) {
    const Vec3 here = support_of(part.part, n);
    const double along = n.dot(here);
    if (along > most) best = here;
    most = std::max(most, along);
  }
  return best;
}

/// Finds planes between ranges of parts and records the steps of the proof.
class ApartSearch {
 public:
  /// Sorts the parts so that neighbours are adjacent; steps name parts by number, so the order stays fixed from here
  /// on.
  explicit ApartSearch(Proof& proof) : proof_(proof) {
    arrange(proof.a);
    arrange(proof.b);
  }
  /// False if some pair has no separating plane in doubles, or the proof would need too many steps.
  bool prove() { return prove(0, proof_.a.size(), 0, proof_.b.size()); }

 private:
  static constexpr std::size_t kMostSteps = 100'000;
  /// Visits of single parts, about 0.2 us each: two surfaces that run closely along each other need very many.
  static constexpr std::size_t kMostLooks = 20'000'000;

  bool prove(std::size_t a0, std::size_t a1, std::size_t b0, std::size_t b1) {
    if (proof_.steps.size() >= kMostSteps || looks_ > kMostLooks) return false;
    const Range a = Range(proof_.a).subspan(a0, a1 - a0);
    const Range b = Range(proof_.b).subspan(b0, b1 - b0);
    if (plane_along_axes(a, b) || plane_between_hulls(a, b)) return true;
    if (a.size() == 1 && b.size() == 1) return plane_of_pair(a[0].part, b[0].part, a, b);
    const bool splits_a = a.size() > 1 && (b.size() == 1 || reach(a) >= reach(b));
    const std::size_t at = splits_a ? a0 + a.size() / 2 : b0 + b.size() / 2;
    proof_.steps.push_back(
        {.kind = splits_a ? ProofStep::Kind::split_a : ProofStep::Kind::split_b, .at = static_cast<std::uint32_t>(at)});
    if (splits_a) return prove(a0, at, b0, b1) && prove(at, a1, b0, b1);
    return prove(a0, a1, b0, at) && prove(a0, a1, at, b1);
  }

  /// The longest side of the bounds, metres.
  static double reach(const Range& parts) {
    const Aabb box = bounds_of_range(parts);
    return (box.high - box.low).maxCoeff();
  }

  /// Splits at the median of the middles along the longest side, then each half in the same way.
  static void arrange(const Range& parts) {
    if (parts.size() < 2) return;
    const Aabb box = bounds_of_range(parts);
    int axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
    std::nth_element(parts.begin(), middle, parts.end(), [&](const ProofPart& x, const ProofPart& y) {
      return middle_of(x.part)[axis] < middle_of(y.part)[axis];
    });
    arrange(parts.first(parts.size() / 2));
    arrange(parts.subspan(parts.size() / 2));
  }

  /// Records the plane if it separates the ranges exactly; else returns false.
  bool keep(const Vec3& normal, const Vec3& point, const Range& a, const Range& b) {
    if (normal.isZero(0) || !normal.allFinite() || !point.allFinite()) return false;
    // A component as small as rounding could make products leave the range of double when the proof is checked, so it
    // is set to zero.
    constexpr double kNothingBeside = 0x1p-100;
    const double least = kNothingBeside * normal.cwiseAbs().maxCoeff();
    if (((normal.array() != 0) && (normal.array().abs() < least)).any()) {
      return keep(Vec3((normal.array().abs() < least).select(0, normal)), point, a, b);
    }
    looks_ += a.size() + b.size();
    const bool parts_them =
        std::all_of(a.begin(), a.end(),
                    [&](const ProofPart& part) { return is_beyond(part.part, normal, point, +1, false); }) &&
        std::all_of(b.begin(), b.end(),
                    [&](const ProofPart& part) { return is_beyond(part.part, normal, point, -1, true); });
    if (parts_them) proof_.steps.push_back({.kind = ProofStep::Kind::plane, .normal = normal, .point = point});
    return parts_them;
  }

  /// Finds a plane if the bounds of the two ranges are separate along an axis.
  bool plane_along_axes(const Range& a, const Range& b) {
    const Aabb of_a = bounds_of_range(a);
    const Aabb of_b = bounds_of_range(b);
    for (int k = 0; k < 3; ++k) {
      Vec3 point = Vec3::Zero();
      Vec3 normal = Vec3::Zero();
      if (of_a.high[k] < of_b.low[k]) {
        normal[k] = 1;
        point[k] = of_a.high[k];
      } else if (of_b.high[k] < of_a.low[k]) {
        normal[k] = -1;
        point[k] = of_a.low[k];
      }
      if (!normal.isZero(0) && keep(normal, point, a, b)) return true;
    }
    return false;
  }

  /// Gilbert's iteration towards the nearest points of the two hulls, for a limited number of steps; stops at the first
  /// separating plane.
  bool plane_between_hulls(const Range& a, const Range& b) {
    if (a.size() + b.size() == 2 || half_space_of(a[0].part) != nullptr || half_space_of(b[0].part) != nullptr)
      return false;
    constexpr int kMostTurns = 48;
    Vec3 on_a = middle_of(a[0].part);
    Vec3 on_b = middle_of(b[0].part);
    for (int i = 0; i < kMostTurns; ++i) {
      const Vec3 displacement = on_b - on_a;
      if (displacement.isZero(0)) return false;
      looks_ += a.size() + b.size();
      const Vec3 far_a = support_of(a, displacement);
      const Vec3 far_b = support_of(b, -displacement);
      if (displacement.dot(far_b - far_a) > 0) return keep(displacement, far_a / 2 + far_b / 2, a, b);
      const Vec3 turn = (far_b - far_a) - displacement;
      const double share =
          std::clamp(-displacement.dot(turn) / std::max(turn.squaredNorm(), kVanishingSquare), 0.0, 1.0);
      on_a += share * (far_a - on_a);
      on_b += share * (far_b - on_b);
    }
    return false;
  }

  /// Tries planes for two single parts: from their distance, their faces and their corners.
  bool plane_of_pair(const ConvexPart& part_a, const ConvexPart& part_b, const Range& a, const Range& b) {
    if (const HalfSpace* ground = half_space_of(part_a)) return keep(ground->normal, ground->point, a, b);
    const Separation apart = separation(part_a, part_b);
    if (const HalfSpace* ground = half_space_of(part_b)) {
      // Halfway between the lowest point of a and the plane; if rounding spoils that, at a's point.
      const Vec3 normal = -ground->normal;
      return keep(normal, apart.on_a / 2 + apart.on_b / 2, a, b) || keep(normal, apart.on_a, a, b) ||
             beside_corners(normal, a, b);
    }
    for (const Vec3& normal : normals_for(apart, part_a, part_b)) {
      if (keep(normal, apart.on_a / 2 + apart.on_b / 2, a, b) || keep(normal, apart.on_a, a, b)) return true;
      if (beside_corners(normal, a, b)) return true;
    }
    return false;
  }

  /// Tries the plane through the corner of a that lies farthest along the normal.
  bool beside_corners(const Vec3& normal, const Range& a, const Range& b) {
    const std::vector<Vec3> points = numbers_of(a[0].part).points;
    const auto farthest = std::max_element(points.begin(), points.end(),
                                           [&](const Vec3& x, const Vec3& y) { return normal.dot(x - y) < 0; });
    return keep(normal, *farthest, a, b);
  }

  static std::vector<Vec3> normals_for(const Separation& apart, const ConvexPart& a, const ConvexPart& b) {
    std::vector<Vec3> normals{apart.normal};
    // In axis-aligned scenes small components of the direction are rounding: also try without them.
    Vec3 squared_up = apart.normal;
    for (double& x : squared_up) x = std::abs(x) < kSquaredUp ? 0 : x;
    normals.push_back(squared_up);
    for (const ConvexPart* part : {&a, &b}) {
      const PartNumbers numbers = numbers_of(*part);
      for (int k = 0; numbers.summand == PartNumbers::Summand::box && k < 3; ++k) {
        const Vec3 n = Vec3(numbers.axes.col((k + 1) % 3)).cross(Vec3(numbers.axes.col((k + 2) % 3)));
        normals.push_back(n.dot(apart.normal) < 0 ? Vec3(-n) : n);
      }
      if (const auto* t = std::get_if<Triangle>(part)) {
        const Vec3 n = (t->b - t->a).cross(t->c - t->a);
        normals.push_back(n.dot(apart.normal) < 0 ? Vec3(-n) : n);
      }
    }
    return normals;
  }

  Proof& proof_;
  std::size_t looks_ = 0;
};

/// Any pair of parts with a proof is enough; tries up to kMostTried touching pairs.
std::optional<Proof> proof_of_touching(const Placed& a, const Placed& b, WalkCost& cost) {
  constexpr int kMostTried = 64;
  int tried = 0;
  std::optional<Proof> proof;
  const auto visit = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    if (!overlaps(of_a.part, of_b.part).yes()) return true;
    Proof found;
    if (prove_touching(of_a.part, of_b.part, engine::contact(of_a.part, of_b.part).point, found)) {
      found.a = {{of_a.part, of_a.triangle}};
      found.b = {{of_b.part, of_b.triangle}};
      proof = std::move(found);
    }
    return !proof && ++tried < kMostTried;
  };
  visit_part_pairs(a, b, 0, visit, cost);
  return proof;
}

}  // namespace

std::optional<Proof> proof_of(const Placed& a, const Placed& b, bool touches, std::string& why_not, WalkCost& cost) {
  if (touches) {
    std::optional<Proof> proof = proof_of_touching(a, b, cost);
    if (!proof)
      why_not = "no common point was found that fractions write down: round sides touch in a single point, or nearly";
    return proof;
  }
  constexpr std::size_t kMostParts = 20'000;
  Proof proof;
  for (const auto& [object, parts] : {std::pair(&a, &proof.a), std::pair(&b, &proof.b)}) {
    for (PlacedPart& part : parts_of(*object)) parts->push_back({std::move(part.part), part.triangle});
  }
  if (proof.a.size() + proof.b.size() > kMostParts) {
    why_not = std::to_string(proof.a.size() + proof.b.size()) + " parts; a certificate tells at most " +
              std::to_string(kMostParts);
    return std::nullopt;
  }
  if (!ApartSearch(proof).prove()) {
    why_not = "no plane that doubles write down passes between some two of the parts, or it would take too many";
    return std::nullopt;
  }
  return proof;
}

}  // namespace collided::engine
