#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/certificate.hpp>
#include <collided/questions.hpp>

/// Two objects by name: how deep they are in each other, or how far apart.
#pragma GCC visibility push(default)

namespace collided {

struct PairOptions {
  bool certificate = false;
  bool triangles = false;
  std::uint32_t most_triangle_pairs = 10'000;  // that are told, at most 100,000
  Instant as_of = {};                          // both at one instant; latest: each at its newest pose
  std::string opinion = {};  // "fcl": what that library says to the pair too; empty: nobody else is asked
  std::chrono::nanoseconds timeout{10'000'000'000};
};

/// One of up to four points that carry a contact, in the middle between the two surfaces.
/// depth_m: how far the two surfaces overlap there along the contact's normal, |truth - depth_m| <= error_m.
struct ManifoldPoint {
  Vec3 point = Vec3::Zero();
  double depth_m = 0;
  double error_m = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
};

/// Two triangles that share a point, and the segment that they share: of triangles in one plane the longest in what they
/// share. Each end is within error_m of a point of both.
struct TrianglePair {
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  double error_m = 0;
};

/// What another library says to the same pair, asked by the server in a process of its own. agree: the same yes or no, and of
/// two that are apart a distance that is ours within a millionth of their size. failed: it broke down or took too long.
/// unsupported: it has no answer for these shapes, or ours is undecided.
enum class OpinionVerdict { agree, differ, failed, unsupported };
struct SecondOpinion {
  OpinionVerdict verdict = OpinionVerdict::unsupported;
  std::optional<bool> touches = {};       // what it says
  std::optional<double> distance_m = {};  // of two that it says are apart, where it has one
  std::string why = {};                   // failed, unsupported; where it has no distance, why not
};

enum class Containment { none, a_in_b, b_in_a };

/// How two objects stand to each other in one state of the world. hit: they share a point; depth_m is the shortest way
/// that parts the two parts that overlap deepest (a part is a triangle or a primitive), along the normal. miss: the
/// distance, with a point of each that has about that distance from the other. With the names the other way round the
/// numbers are the same, and the normal is turned round.
struct PairAnswer {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason =
      UndecidedReason::none;  // numeric: both answers are consistent with the input; stale_object: see stale
  /// One of the two moved when it was last heard of (its publisher is lost, or has not come to the instant asked for): the
  /// numbers are those of where it was then. A miss is said only where it cannot have come to the other since.
  bool stale = false;
  std::uint64_t version = 0;
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  double distance_m = 0;       // miss; |truth - distance_m| <= error_m
  double depth_m = 0;          // hit; |truth - depth_m| <= error_m
  double error_m = 0;
  Vec3 on_a = Vec3::Zero();  // miss; within point_error_m of a
  Vec3 on_b = Vec3::Zero();
  double point_error_m = 0;
  Vec3 point = Vec3::Zero();  // hit; in the middle of the deepest overlap
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::vector<ManifoldPoint> manifold;
  /// miss: the surfaces share no point, and one object lies within the other's closed mesh.
  Containment contained = Containment::none;
  std::vector<TrianglePair> triangle_pairs;  // by a_triangle, then b_triangle
  std::uint64_t triangle_pair_count = 0;     // all that there are: more than told where `cut`
  bool cut = false;
  std::optional<Certificate> certificate;
  std::string no_certificate;  // why there is none although it was asked for
  std::optional<SecondOpinion> opinion;
};

}  // namespace collided

#pragma GCC visibility pop
