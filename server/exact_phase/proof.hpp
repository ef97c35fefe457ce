#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// Exact numbers as sums of doubles, for who checks them elsewhere.
using ExactSum = std::vector<double>;
using ExactMix = std::vector<std::pair<std::uint32_t, ExactSum>>;


/// As Certificate::Step in collided/certificate.hpp.
struct ProofStep {
  enum class Kind : std::uint8_t { plane, split_a, split_b };
  Kind kind = Kind::plane;
  Vec3 normal = Vec3::Zero();
  Vec3 point = Vec3::Zero();
  std::uint32_t at = 0;
};

/// A part's numbers as CertifiedPart in collided/certificate.hpp has them.
struct PartNumbers {
  enum class Summand : std::uint8_t { nothing, ball, box, ellipsoid, disc, half_space };
  Summand summand = Summand::nothing;
  std::vector<Vec3> points;
  double radius_m = 0;
  bool tapers = false;
  Mat3 axes = Mat3::Zero();
  Vec3 half_m = Vec3::Zero();
};
PartNumbers numbers_of(const ConvexPart& part);

/// About the part's farthest point along n; not of a half-space.
Vec3 support_of(const ConvexPart& part, const Vec3& n);

/// A part with its triangle's number.
struct ProofPart {
  ConvexPart part;
  std::uint32_t triangle = 0xffffffff;
};

/// Why two objects touch or do not, to be checked by who trusts nobody (collided/certificate.hpp has the reader's side).
struct Proof {
  bool touches = false;
  std::vector<ProofPart> a;
  std::vector<ProofPart> b;
  std::vector<ProofStep> steps;
  ExactSum point[3];
  ExactSum divisor;
  ExactMix mix_a;
  ExactMix mix_b;
};

/// A point of both parts, exactly, and of what it is made; `hint` lies near the middle of what they share. Nothing where
/// none was found that rationals write down: shapes with round sides that touch in one point.
/// cost  0.1 to 10 ms; allocates
bool prove_touching(const ConvexPart& a, const ConvexPart& b, const Vec3& hint, Proof& proof);

/// Whether every point x of the part has side * normal . (x - point) <= 0, or < 0 where strictly.
bool is_beyond(const ConvexPart& part, const Vec3& normal, const Vec3& point, int side, bool strictly);

}  // namespace collided::engine
