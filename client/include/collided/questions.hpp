#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <collided/geometry.hpp>

/// Rays, spheres, boxes, nearest points and sweeps: what is asked, what may answer, what comes back.
#pragma GCC visibility push(default)

namespace collided {

enum class HitMode { closest, any, all };
/// Of a server that cannot answer all: low questions are refused first, high ones never.
enum class Importance { normal, low, high };

/// direction  finite, non-zero, any length; length_m in [0, inf]
struct RayQuestion {
  Vec3 origin;
  Vec3 direction;
  double length_m = std::numeric_limits<double>::infinity();
};
struct SphereQuestion {
  Vec3 center;
  double radius_m = 0;
};
struct BoxQuestion {
  Vec3 center;
  Vec3 half_m;
  Quat rotation = Quat::Identity();
};
/// What stands nearest to a point, AskOptions::max_hits of them.
struct NearQuestion {
  Vec3 point;
  double within_m = std::numeric_limits<double>::infinity();
};
template <class T>
concept Question = std::is_same_v<T, RayQuestion> || std::is_same_v<T, SphereQuestion> ||
    std::is_same_v<T, BoxQuestion> || std::is_same_v<T, NearQuestion>;

/// The way of a shape while time runs from 0 to 1: its origin goes straight at even speed, and it turns at even speed
/// about a fixed axis, the short way round.
struct SweepQuestion {
  Pose from;
  Pose to;
};

/// The instant that a question is about.
/// latest   each object at its newest pose; those of several publishers differ by their periods
/// settled  the newest instant at which it is known where every object was
/// at       since 1970, by the publishers' clocks
/// back     so long before the server's newest
/// Of an instant that is later than `settled`, whatever an object not known so far could change is undecided (stale_object).
/// A server remembers some seconds (--memory) and refuses what lies before.
struct Instant {
  enum class Kind { latest, settled, at, back };
  Kind kind = Kind::latest;
  std::chrono::nanoseconds time{0};  // of `at` and `back`, not negative
};

/// What may answer, and how well.
struct AskOptions {
  HitMode mode = HitMode::closest;  // rays only
  std::uint32_t mask = 0xffffffff;  // layers that may answer
  std::string only = {};            // name glob (* ? [...]), empty: everything
  std::string skip = {};            // name glob, empty: nothing
  /// Per question. Of near: so many nearest ones. Of the others: more are cut, and the answer is undecided (truncated).
  /// None: 1 of near, 1,000 of the others.
  std::optional<std::uint32_t> max_hits = {};
  double error_m = 0;                               // error asked; 0: exact on doubt
  std::chrono::nanoseconds deadline{0};             // 0: none; later answers are undecided (deadline)
  std::chrono::nanoseconds timeout{2'000'000'000};  // how long the caller waits
  bool fresh = false;                               // answer after this connection's own last write
  Instant as_of = {};                               // Answers::world_time says which instant it was
  Importance importance = Importance::normal;
};

enum class Verdict { miss, hit, undecided, invalid };
enum class UndecidedReason { none, numeric, stale_object, recovering, truncated, deadline, not_covered };

/// Ray: distance along the ray. Sphere and box: depth_m is how deep (>= 0). Near: distance from the point.
/// |truth - distance_m| <= error_m. Sweep: the first contact, in the bracket of times; no distance.
struct Hit {
  std::string object;
  std::uint64_t object_id = 0;
  std::uint32_t triangle = kNoTriangle;
  double distance_m = 0;
  double error_m = 0;
  double exit_m = 0;
  Vec3 point = Vec3::Zero();
  double point_error_m = 0;  // |true point - point| at most; infinite for contacts, which have many points
  Vec3 normal = Vec3::Zero();
  Vec3 weights = Vec3::Zero();
  double time_low = 0;   // sweeps: no contact up to here,
  double time_high = 0;  // and contact here
  bool inside = false;   // rays: the origin is inside the solid; near: the point is in it or on it; else never set
  bool stale = false;
};

struct Cost {
  std::uint32_t nodes = 0;
  std::uint32_t exact_tests = 0;
  int level = 0;  // 0 double filter, 1 expansions or intervals, 2 rationals
};

/// Where what was asked leaves the space in which the server's geometry is complete, and how far rays are covered at least.
struct Uncovered {
  Vec3 point = Vec3::Zero();
  double covered_m = 0;
};

struct Answer {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  std::vector<Hit> hits;  // ordered by (distance, object id, triangle)
  Cost cost;
  std::optional<Uncovered> uncovered = {};  // with reason not_covered
};

/// One request's answers, all on one state of the world.
struct Answers {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::chrono::nanoseconds world_time{0};
  std::optional<std::chrono::nanoseconds> oldest_pose_age;  // none: only static geometry decided
  std::chrono::nanoseconds compute{0};
  std::vector<Answer> answers;  // one a question, in order
};

}  // namespace collided

#pragma GCC visibility pop
