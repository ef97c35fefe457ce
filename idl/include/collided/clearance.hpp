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

/// The clearance between two groups of objects, with the pairs that decide it. Metres, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

using codes::Containment;

/// Which pairs Client::clearance searches, and how many it reports. A group is named by an object, by a scene (all its
/// objects) or by a glob (* ? [..]); an empty group is an error.
struct ClearanceOptions {
  std::string to = {};     // the other group; empty: all objects not in the first
  std::string skip = {};   // glob of objects to leave out of both; empty: none
  std::uint32_t most = 1;  // nearest pairs reported; 1 to 10,000, with certificates to 1,000
  double nearer_m = std::numeric_limits<double>::infinity();  // report no pairs certainly farther apart; 0 or more
  bool with_filtered = false;                                 // also report pairs that masks and groups exclude
  bool certificate = false;                          // a proof for each pair that it touches, or that it is apart
  Instant as_of = {};                                // instant for all objects; latest: each at its newest pose
  std::chrono::nanoseconds deadline{0};              // on the server; 0: only the timeout
  std::chrono::nanoseconds timeout{10'000'000'000};  // for the answer; with progress, for each message
  /// Called up to ten times a second, on the calling thread, with a lower bound on the fraction of pairs done; an
  /// exception from it ends the question.
  std::function<void(double)> progress = {};
};

/// One object of the first group and one of the other.
struct ClearancePair {
  std::string a;  // of the first group
  std::string b;
  std::uint64_t a_id = 0;  // the server's numbers for them
  std::uint64_t b_id = 0;
  Verdict verdict = Verdict::miss;  // hit: they touch, or one lies within the other, a solid
  bool stale = false;  // one of them may have moved since its publisher was lost; the numbers are for its last pose
  /// Their distance. If they touch: minus the depth of the deepest pair of parts. If one lies within a solid: minus the
  /// distance of the surfaces. |truth - clearance_m| <= error_m.
  double clearance_m = 0;
  double error_m = 0;
  Containment contained = Containment::none;  // which lies within the other, a solid, without touching its surface
  Vec3 on_a = Vec3::Zero();  // nearest points, within point_error_m; of a contact both the middle of the overlap
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
  /// hit: a pair touches. Undecided if no pair certainly touches and a pair is undecided, not all pairs were tested, or
  /// the search leaves the covered space.
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  std::vector<ClearancePair> pairs =
      {};              // least clearance first; empty if all are certainly farther apart than requested
  bool cut = false;    // more pairs are within ClearanceOptions::nearer_m than `most`
  bool late = false;   // the deadline passed: a nearer pair may be missing
  bool stale = false;  // an object of a lost publisher may now be in a nearer pair
  /// Without ClearanceOptions::to, if covered space is declared: an uncovered point that is nearer than the reported
  /// pairs.
  std::optional<Vec3> uncovered = {};
  std::uint64_t from_count = 0;  // objects of the first group
  std::uint64_t to_count = 0;    // and of the other
  std::uint64_t filtered = 0;    // pairs near enough but excluded by masks or groups
  std::uint64_t tested = 0;      // pairs whose parts were tested
  std::uint64_t version = 0;     // of the state
};

}  // namespace collided

#pragma GCC visibility pop
