#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// Exact numbers as sums of doubles, so that other programs can check them.
using ExactSum = std::vector<double>;
/// Weights of a part's points: (number of the point, weight).
using ExactMix = std::vector<std::pair<std::uint32_t, ExactSum>>;

/// One step of a proof of separation; same as Certificate::Step in collided/certificate.hpp.
struct ProofStep {
  enum class Kind : std::uint8_t { plane, split_a, split_b };
  Kind kind = Kind::plane;
  Vec3 normal = Vec3::Zero();
  Vec3 point = Vec3::Zero();
  std::uint32_t at = 0;  // index at which the range of parts is split
};

/// A part's numbers in the form of CertifiedPart in collided/certificate.hpp.
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

/// Approximate farthest point of the part along n; not for a half-space.
Vec3 support_of(const ConvexPart& part, const Vec3& n);

/// A part with its triangle's number, or 0xffffffff.
struct ProofPart {
  ConvexPart part;
  std::uint32_t triangle = 0xffffffff;
};

/// A proof that two objects touch or do not, which a client can check without trusting the server
/// (collided/certificate.hpp has the client's side).
struct Proof {
  bool touches = false;
  // All parts that the steps refer to; if the objects touch, the one part of each.
  std::vector<ProofPart> a;
  std::vector<ProofPart> b;
  std::vector<ProofStep> steps;
  // If they touch: the common point, point / divisor, as a weighted mix of each part's points.
  ExactSum point[3];
  ExactSum divisor;
  ExactMix mix_a;
  ExactMix mix_b;
};

/// Finds a point that lies exactly in both parts, with its mix. False if no such rational point was found: shapes with
/// round sides that touch in a single point.
///
/// hint  near the middle of the overlap
/// cost  0.1 to 10 ms; allocates
bool prove_touching(const ConvexPart& a, const ConvexPart& b, const Vec3& hint, Proof& proof);

/// True if every point x of the part has side * normal . (x - point) <= 0, or < 0 if `strictly`. Exact.
bool is_beyond(const ConvexPart& part, const Vec3& normal, const Vec3& point, int side, bool strictly);

}  // namespace collided::engine
