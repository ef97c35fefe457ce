#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <collided/codes.hpp>
#include <collided/geometry.hpp>

/// Rays, spheres, boxes, nearest points and sweeps: the questions, the options that go with them, and the answers.
/// Metres and world coordinates throughout; all numbers of a question finite unless infinity is allowed below.
#pragma GCC visibility push(default)

namespace collided {

/// Which hits are wanted.
/// closest      of a ray the first hit; of other questions the same as all
/// any          of a ray one hit, not necessarily the first; of a sphere, a box or inside yes or no, without a depth
/// all          every hit
/// signed_near  of near: where a solid holds the point, the distance is minus the depth instead of 0
/// verdict      none: hit or miss alone, the answer has no hits. Of rays, spheres, boxes and inside; the cheapest where
///              only that counts, as of a line of sight
using codes::HitMode;
using codes::Importance;

/// What does a ray hit?
struct RayQuestion {
  Vec3 origin;
  Vec3 direction;                                             // not zero, any length
  double length_m = std::numeric_limits<double>::infinity();  // 0 to infinity
};
/// What touches a sphere, and how deep?
struct SphereQuestion {
  Vec3 center;
  double radius_m = 0;  // 0 or more
};
/// What touches a box, and how deep?
struct BoxQuestion {
  Vec3 center;
  Vec3 half_m;                       // half of each edge, along the box's own axes; 0 or more
  Quat rotation = Quat::Identity();  // from the box's axes to the world
};
/// Which objects are nearest to a point? The answer has as many as AskOptions::max_hits.
struct NearQuestion {
  Vec3 point;
  double within_m = std::numeric_limits<double>::infinity();  // the largest distance, 0 to infinity
};
/// Which solids hold a point, and how deep is it in each? Solid are spheres, boxes and all shapes but meshes, and meshes
/// that were declared solid when they were loaded or added.
struct InsideQuestion {
  Vec3 point;
};
/// The question types that Client::ask takes.
template <class T>
concept Question = std::is_same_v<T, RayQuestion> || std::is_same_v<T, SphereQuestion> ||
    std::is_same_v<T, BoxQuestion> || std::is_same_v<T, NearQuestion> || std::is_same_v<T, InsideQuestion>;

/// A motion of a shape while time runs from 0 to 1: its origin moves along a straight line at constant speed, and it
/// turns at constant speed about a fixed axis, by the smaller angle. Client::sweep takes it together with the shape.
struct SweepQuestion {
  Pose from;
  Pose to;
};

/// The instant that a question is about.
/// latest   each object at its newest pose; the poses of different publishers are apart by their periods
/// settled  the newest instant up to which every publisher has said where its objects are
/// at       a time since 1970, by the publishers' clocks
/// back     a time before the newest instant that the server knows
/// For an instant later than `settled`, an answer is undecided (stale_object) where an object that has no pose for that
/// instant yet could change it. The server remembers some seconds (its option --memory) and refuses earlier instants.
struct Instant {
  using Kind = codes::InstantKind;
  Kind kind = Kind::latest;
  std::chrono::nanoseconds time{0};  // for `at` and `back`, not negative
};

/// Where the server has replicas (ConnectOptions::replicas), they answer too. What holds then: an answer says who gave it
/// (Answers::server) and which instant it is about; `at` an instant all give the same answer; `settled` instants of one Client
/// never go back, unless the servers are apart by half the timeout; `latest` ones may, by what poses take to one server and to
/// the other; what this Client's own commands changed is in, and with `fresh` what it published.
///
/// Which objects may answer, how accurately, and how long it may take.
struct AskOptions {
  HitMode mode = HitMode::closest;
  std::uint32_t mask = 0xffffffff;  // objects with one of these layers may answer
  std::string only = {};            // name glob (* ? [...]) of objects that may answer; empty: all
  std::string skip = {};            // name glob of objects that are left out; empty: none
  /// For each question. For near: the number of nearest objects. For the others: hits beyond this number are cut off,
  /// and the answer is undecided (truncated). Not set: 1 for near, 1,000 for the others.
  std::optional<std::uint32_t> max_hits = {};
  double error_m = 0;                               // error allowed in distances; 0: computed exactly where in doubt
  std::chrono::nanoseconds deadline{0};             // on the server; answers after it are undecided; 0: none
  std::chrono::nanoseconds timeout{2'000'000'000};  // how long the call waits for the answers, above 0
  bool fresh = false;                               // answer only after this connection's own last write is applied
  Instant as_of = {};                               // Answers::world_time says which instant it was
  Importance importance = Importance::normal;       // of all questions of the call
};

using codes::UndecidedReason;
using codes::Verdict;

/// One object, or one triangle of it, that answers a question.
struct Hit {
  std::string object;                    // its name
  std::uint64_t object_id = 0;           // the number of it at Answers::server
  std::uint32_t triangle = kNoTriangle;  // of the object's mesh
  /// For a ray: from its origin along it. For a sphere or box: the depth, which is 0 or more. For inside: the depth of the
  /// point, from the nearest point of the surface. For near: from the point, see HitMode::signed_near.
  /// |truth - distance_m| <= error_m. For a sweep: 0, see time_low.
  double distance_m = 0;
  double error_m = 0;
  double exit_m =
      0;  // for rays: where the ray leaves a convex solid or, from within a declared one, meets its surface; else 0
  Vec3 point = Vec3::Zero();
  double point_error_m = 0;  // |true point - point| at most; infinite for contacts, which have many points
  /// Unit. For a ray: against the ray; where it begins inside, outward where it leaves. For near: from the object
  /// towards the point. For a sphere, box or sweep: from the shape that was asked about to the object.
  Vec3 normal = Vec3::Zero();
  Vec3 weights = Vec3::Zero();  // of the triangle's corners in `point`; 0 for primitives
  double time_low = 0;          // for sweeps, 0 to 1: no contact up to here ...
  double time_high = 0;         // ... and contact by here
  // rays, sweeps: the origin, or the shape at its first pose, is in the solid; near, inside: the point is in it or on it
  bool inside = false;
  /// The mesh does not close, and its winding number, above 1/2, says inside: distance_m is how far its surface is (near:
  /// with a minus), which is no depth, since a way out may lead through a hole.
  bool by_winding = false;
  bool stale = false;  // where the object is now is not known: its publisher is lost (LostPolicy::freeze)
};

/// What it took to answer a question.
struct Cost {
  std::uint32_t nodes = 0;        // of indexes, visited
  std::uint32_t exact_tests = 0;  // of a triangle or primitive
  int level = 0;                  // arithmetic needed: 0 filter in double, 1 error-free sums or intervals, 2 rationals
};

/// Where a question leaves the space in which the server's geometry is complete.
struct Uncovered {
  Vec3 point = Vec3::Zero();  // where it leaves that space
  double covered_m = 0;       // the distance up to there is covered
};

/// The answer to one question.
struct Answer {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;  // for verdict undecided
  /// Nearest first, of a sphere, a box or inside deepest first; equal ones by object id, then triangle. An undecided answer has
  /// the hits that were found.
  std::vector<Hit> hits;
  Cost cost;
  std::optional<Uncovered> uncovered = {};  // with reason not_covered
};

/// The answers to one request, all about one state of the world.
struct Answers {
  std::uint64_t epoch = 0;                                  // grows with each start of a server
  std::uint64_t version = 0;                                // of that state; grows with each change of the world
  std::chrono::nanoseconds world_time{0};                   // of that state, since 1970, by the publishers' clocks
  std::optional<std::chrono::nanoseconds> oldest_pose_age;  // of the poses that decided; none: only static geometry did
  std::chrono::nanoseconds compute{0};  // on the server, from taking the questions to replying; summed over messages
  std::uint64_t server = 0;             // that answered, the primary or a replica: FleetMember::server
  std::vector<Answer> answers;          // one for each question, in order
};

}  // namespace collided

#pragma GCC visibility pop
