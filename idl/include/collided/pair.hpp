#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/certificate.hpp>
#include <collided/codes.hpp>
#include <collided/questions.hpp>

/// Two objects by name: whether they touch, how deep they are in each other, or how far apart. Metres, world
/// coordinates.
#pragma GCC visibility push(default)

namespace collided {

/// What Client::pair reports in addition to the answer.
struct PairOptions {
  bool certificate = false;                    // a proof of the answer
  bool triangles = false;                      // every pair of triangles that touch, for two meshes
  std::uint32_t most_triangle_pairs = 10'000;  // reported; at most 100,000
  Instant as_of = {};                          // of both objects; latest: each at its newest pose
  std::string opinion = {};                    // "fcl": also the answer of the library FCL; empty: none
  std::chrono::nanoseconds deadline{0};        // on the server; undecided if more time is needed; 0: only the timeout
  std::chrono::nanoseconds timeout{10'000'000'000};  // for the answer
};

/// One of up to four points that carry a contact, half-way between the two surfaces.
struct ManifoldPoint {
  Vec3 point = Vec3::Zero();
  double depth_m = 0;  // how far the surfaces overlap there along the contact's normal; |truth - depth_m| <= error_m
  double error_m = 0;
  std::uint32_t a_triangle = kNoTriangle;  // of a's mesh, at the point
  std::uint32_t b_triangle = kNoTriangle;  // of b's mesh
};

/// Two triangles that share a point, and the segment that they share. Coplanar triangles share an area; then it is the
/// longest segment in that area.
struct TrianglePair {
  std::uint32_t a_triangle = kNoTriangle;  // of a's mesh
  std::uint32_t b_triangle = kNoTriangle;  // of b's mesh
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  double error_m = 0;  // each end is within this distance of a point of both triangles
};

using codes::Containment;
using codes::OpinionVerdict;

/// The answer of another library about the same pair. The server runs it in a separate process.
struct SecondOpinion {
  OpinionVerdict verdict = OpinionVerdict::unsupported;
  std::optional<bool> touches = {};       // its answer, if it has one
  std::optional<double> distance_m = {};  // if it answers that the two are apart and gives a distance
  std::string why = {};                   // why it failed, does not support the shapes, or gives no distance
};

/// The answer about two objects in one state of the world. Swapping the names reverses the normal and changes no
/// number.
/// hit   they share a point. A part is a triangle or a primitive. The depth is that of the two parts that overlap
///       deepest: moving b's part by depth_m along the normal separates these two, and no shorter motion does
/// miss  they are distance_m apart; on_a and on_b are points of theirs at about that distance from each other
struct PairAnswer {
  Verdict verdict = Verdict::miss;
  /// numeric: hit and miss are both consistent with the input. stale_object: see `stale`.
  UndecidedReason reason = UndecidedReason::none;
  /// The current pose of one of the two is unknown: its publisher is lost, or has not sent a pose for the requested
  /// instant yet. The numbers are for its last pose. The verdict is a miss only if the two cannot have met since.
  bool stale = false;
  std::uint64_t version = 0;   // of the state
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  double distance_m = 0;       // for a miss; |truth - distance_m| <= error_m
  double depth_m = 0;          // for a hit, and a miss with is_in_solid; |truth - depth_m| <= error_m
  double error_m = 0;
  Vec3 on_a = Vec3::Zero();  // for a miss; within point_error_m of a
  Vec3 on_b = Vec3::Zero();  // for a miss; within point_error_m of b
  double point_error_m = 0;
  Vec3 point = Vec3::Zero();               // for a hit: in the middle of the deepest overlap
  std::uint32_t a_triangle = kNoTriangle;  // for a hit: the deepest parts, if they are triangles
  std::uint32_t b_triangle = kNoTriangle;
  std::vector<ManifoldPoint> manifold = {};  // for a hit
  /// For a miss: the surfaces share no point, but one object lies within the other.
  Containment contained = Containment::none;
  /// The outer one was declared solid: no motion shorter than depth_m takes the inner one out of it, and one of depth_m
  /// + depth_error_m does. The signed distance of the two is -depth_m.
  bool is_in_solid = false;
  double depth_error_m = 0;
  std::vector<TrianglePair> triangle_pairs = {};  // ordered by a_triangle, then b_triangle
  std::uint64_t triangle_pair_count = 0;          // number of all such pairs, more than reported if `cut`
  bool cut = false;                               // there are more than PairOptions::most_triangle_pairs
  std::optional<Certificate> certificate = {};    // see proves()
  std::string no_certificate = {};                // why there is none although it was requested
  std::optional<SecondOpinion> opinion = {};      // if requested
};

}  // namespace collided

#pragma GCC visibility pop
