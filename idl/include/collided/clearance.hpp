#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <collided/certificate.hpp>
#include <collided/codes.hpp>
#include <collided/questions.hpp>

/// How near two groups of objects are to each other, with the pairs that decide it. Metres, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

using codes::Containment;

/// Which pairs Client::clearance looks at, and how many it reports. A group is named by an object, by a scene (all that
/// was loaded with it) or by a glob (* ? [..]); one that has no object is an error.
struct ClearanceOptions {
  std::string to = {};     // the other group; empty: all objects that the first has not
  std::string skip = {};   // glob of objects that are left out of both; empty: none
  std::uint32_t most = 1;  // nearest pairs reported; 1 to 10,000, with certificates to 1,000
  double nearer_m = std::numeric_limits<double>::infinity();  // pairs surely farther apart are not reported; 0 or more
  bool with_filtered = false;                        // also pairs that masks and groups let pass through each other
  bool certificate = false;                          // a proof for each pair: that it touches, or that it is apart
  Instant as_of = {};                                // of all objects; latest: each at its newest pose
  std::chrono::nanoseconds deadline{0};              // on the server; 0: none but the timeout
  std::chrono::nanoseconds timeout{10'000'000'000};  // for the answer; with progress, for each sign of life
  /// Called ten times a second or less often, on the calling thread, with the fraction of the pairs that were looked at,
  /// at least; what it throws ends the question.
  std::function<void(double)> progress = {};
};

/// One object of the first group and one of the other.
struct ClearancePair {
  std::string a;  // of the first group
  std::string b;
  std::uint64_t a_id = 0;  // the server's numbers for them
  std::uint64_t b_id = 0;
  Verdict verdict = Verdict::miss;  // hit: they touch, or one lies within the other, which is solid
  bool stale = false;  // where one of them is now is not known; the numbers are for where its lost publisher said last
  /// Their distance; where they touch, minus the depth of the deepest pair of parts; where one lies within a solid, minus
  /// the distance of the surfaces. |truth - clearance_m| <= error_m.
  double clearance_m = 0;
  double error_m = 0;
  Containment contained = Containment::none;  // which lies within the other, a solid, without touching its surface
  Vec3 on_a = Vec3::Zero();  // nearest points, within point_error_m; where they touch both in the middle of the overlap
  Vec3 on_b = Vec3::Zero();
  double point_error_m = 0;
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::optional<Certificate> certificate = {};  // see proves()
  std::string no_certificate = {};              // why there is none although it was requested
};

/// The nearest pairs of two groups in one state of the world.
struct ClearanceAnswer {
  /// hit: a pair touches. Undecided where that is open of a pair, or not all pairs were looked at, or it reaches out of what is
  /// covered, and no pair surely
  /// touches.
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  std::vector<ClearancePair> pairs =
      {};              // least clearance first; empty where all are surely farther apart than asked for
  bool cut = false;    // more pairs are within ClearanceOptions::nearer_m than were to be reported
  bool late = false;   // the deadline was over: a nearer pair may be missing
  bool stale = false;  // an object of a lost publisher may by now be in a pair that is nearer
  /// Without ClearanceOptions::to, where space is stated to be covered: a point that is not, and nearer than what is told.
  std::optional<Vec3> uncovered = {};
  std::uint64_t from_count = 0;  // objects of the first group
  std::uint64_t to_count = 0;    // and of the other
  std::uint64_t filtered = 0;    // pairs near enough to be looked at that may pass through each other: left out
  std::uint64_t tested = 0;      // pairs whose parts were looked at
  std::uint64_t version = 0;     // of the state
};

}  // namespace collided

#pragma GCC visibility pop
