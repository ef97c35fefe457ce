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

/// Which hits an answer contains.
/// closest      for a ray the first hit; for other questions the same as all
/// any          for a ray one hit, not necessarily the first; for a sphere, a box or inside yes or no, without a depth
/// all          every hit
/// signed_near  for near: if a solid contains the point, the distance is minus the depth instead of 0
/// verdict      none: the answer is hit or miss, without hits. For rays, spheres, boxes and inside; the cheapest mode,
///              for example for a line of sight
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
/// Which objects are nearest to a point? The answer has up to AskOptions::max_hits.
struct NearQuestion {
  Vec3 point;
  double within_m = std::numeric_limits<double>::infinity();  // the largest distance, 0 to infinity
};
/// Which solids contain a point, and how deep is it in each? All shapes except meshes are solid, and so are meshes
/// declared solid when they were loaded or added.
struct InsideQuestion {
  Vec3 point;
};
/// The question types that Client::ask takes.
template <class T>
concept Question = std::is_same_v<T, RayQuestion> || std::is_same_v<T, SphereQuestion> ||
    std::is_same_v<T, BoxQuestion> || std::is_same_v<T, NearQuestion> || std::is_same_v<T, InsideQuestion>;

/// A motion of a shape from time 0 to 1: its origin moves along a straight line at constant speed, and it turns at
/// constant speed about a fixed axis, by the smaller angle. Client::sweep takes it together with the shape.
struct SweepQuestion {
  Pose from;
  Pose to;
};

/// The instant that a question is about.
/// latest   each object at its newest pose; poses of different publishers differ in time by up to their periods
/// settled  the newest instant up to which every publisher has reported its objects
/// at       a time since 1970, by the publishers' clocks
/// back     a time before the newest instant that the server knows
/// For an instant later than `settled`, an answer is undecided (stale_object) if an object without a pose for that
/// instant could change it. The server remembers some seconds (its option --memory) and refuses earlier instants.
struct Instant {
  using Kind = codes::InstantKind;
  Kind kind = Kind::latest;
  std::chrono::nanoseconds time{0};  // for `at` and `back`, not negative
};

/// Which objects may answer, how accurately, and how long it may take.
///
/// Replicas of the server answer too (ConnectOptions::replicas). Answers::server names the server that answered, and
/// Answers::world_time the instant. All servers give the same answer for `at`. `settled` instants of one Client never
/// go back, unless the servers differ by half the timeout. `latest` ones may, by the difference in the delays of poses.
/// An answer includes the effects of this Client's own commands, and with `fresh` also its published poses.
struct AskOptions {
  HitMode mode = HitMode::closest;
  std::uint32_t mask = 0xffffffff;  // objects with one of these layers may answer
  std::string only = {};            // name glob (* ? [...]) of objects that may answer; empty: all
  std::string skip = {};            // name glob of objects to leave out; empty: none
  /// Limit for each question. For near it is the number of nearest objects. For others, further hits are cut off, and
  /// the answer is undecided (truncated). Not set: 1 for near, 1,000 for the others.
  std::optional<std::uint32_t> max_hits = {};
  double error_m = 0;                               // allowed error of distances; 0: exact arithmetic if in doubt
  std::chrono::nanoseconds deadline{0};             // on the server; answers after it are undecided; 0: none
  std::chrono::nanoseconds timeout{2'000'000'000};  // for the whole call, above 0
  bool fresh = false;                               // answer only after this connection's own last write is applied
  Instant as_of = {};                               // Answers::world_time is the actual instant
  Importance importance = Importance::normal;       // for all questions of the call
};

using codes::UndecidedReason;
using codes::Verdict;

/// A hit: an object, or one triangle of it, that answers a question.
struct Hit {
  std::string object;                    // its name
  std::uint64_t object_id = 0;           // its number at Answers::server
  std::uint32_t triangle = kNoTriangle;  // of the object's mesh
  /// For a ray: the distance along it. For a sphere or box: the depth, 0 or more. For inside: the depth of the point,
  /// from the nearest point of the surface. For near: the distance from the point, see HitMode::signed_near. |truth -
  /// distance_m| <= error_m. For a sweep: 0, see time_low.
  double distance_m = 0;
  double error_m = 0;
  /// For rays: where the ray leaves a convex solid or, from within a declared one, hits its surface; else 0.
  double exit_m = 0;
  Vec3 point = Vec3::Zero();
  double point_error_m = 0;  // |true point - point| at most; infinite for contacts, which have many points
  /// Unit. For a ray: against its direction; if the ray begins inside, outward at its exit. For near: from the object
  /// towards the point. For a sphere, box or sweep: from the question's shape to the object.
  Vec3 normal = Vec3::Zero();
  Vec3 weights = Vec3::Zero();  // of the triangle's corners in `point`; 0 for primitives
  double time_low = 0;          // for sweeps, 0 to 1: no contact before this ...
  double time_high = 0;         // ... and contact by this
  // rays, sweeps: the origin, or the shape at its first pose, is in the solid; near, inside: the point is in or on it
  bool inside = false;
  /// The mesh does not close, and its winding number is above 1/2, which counts as inside. distance_m is then the
  /// distance to its surface (for near: negative). It is not a depth, since a way out may lead through a hole.
  bool by_winding = false;
  bool stale = false;  // the object may have moved: its publisher is lost (LostPolicy::freeze)
};

/// The work for an answer.
struct Cost {
  std::uint32_t nodes = 0;        // of indexes, visited
  std::uint32_t exact_tests = 0;  // of a triangle or primitive
  int level = 0;                  // of arithmetic: 0 filter in double, 1 error-free sums or intervals, 2 rationals
};

/// Where a question leaves the space in which the server's geometry is complete.
struct Uncovered {
  Vec3 point = Vec3::Zero();  // of exit
  double covered_m = 0;       // distance up to that point
};

/// The answer to one question.
struct Answer {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;  // for verdict undecided
  /// Nearest first; for a sphere, a box or inside deepest first. Ties are ordered by object id, then triangle. An
  /// undecided answer has the hits found.
  std::vector<Hit> hits;
  Cost cost;
  std::optional<Uncovered> uncovered = {};  // with reason not_covered
};

/// The answers to one request, all about one state of the world.
struct Answers {
  std::uint64_t epoch = 0;                                  // grows with each start of a server
  std::uint64_t version = 0;                                // of that state; grows with each change of the world
  std::chrono::nanoseconds world_time{0};                   // of that state, since 1970, by the publishers' clocks
  std::optional<std::chrono::nanoseconds> oldest_pose_age;  // of the poses that decided; none: static geometry decided
  std::chrono::nanoseconds compute{0};  // on the server, from receipt to reply; summed over messages
  std::uint64_t server = 0;             // the primary or replica that answered: FleetMember::server
  std::vector<Answer> answers;          // one for each question, in order
};

}  // namespace collided

#pragma GCC visibility pop
