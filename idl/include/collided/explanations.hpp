#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/geometry.hpp>
#include <collided/listed_standing.hpp>
#include <collided/pair.hpp>
#include <collided/questions.hpp>

/// Explanations: why a ray, a pair of objects, a standing question or an event has its answer and not another one.
/// Metres, world coordinates; times are world times since 1970. idl/answers/explanation.hpp lists their names in JSON.
#pragma GCC visibility push(default)

namespace collided {

/// Options of an explanation.
struct ExplainOptions {
  std::uint32_t mask = 0xffffffff;  // for rays, as in AskOptions; so are only and skip
  std::string only = {};
  std::string skip = {};
  Instant as_of = {};        // for rays and pairs; latest: each object at its newest pose
  std::string why_not = {};  // for rays and standing questions: an object that is reported in any case
  std::uint32_t most = 3;    // for rays and standing questions: number of misses, or of other objects, to report
  std::chrono::nanoseconds last{0};      // for pairs: how far back to search; 0: all that the server remembers
  std::chrono::nanoseconds deadline{0};  // on the server, which then returns a partial result; 0: only the timeout
  std::chrono::nanoseconds timeout{10'000'000'000};  // for the answer
};

// ---- a ray ---------------------------------------------------------------------------------------------------------

/// The arithmetic that a decision needed.
enum class Rung { filter, expansion, rational };

/// An object that the ray hits.
struct ExplainedMeeting {
  std::string object = {};
  std::string kind = {};  // box, sphere, ..., mesh, compound
  double distance_m = 0;  // |truth - distance_m| <= error_m
  double error_m = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  std::uint32_t triangle = kNoTriangle;
  std::optional<std::uint32_t> part = {};  // which of several primitives of the object
  Rung rung = Rung::filter;
  bool inside = false;                               // the ray begins in it
  bool stale = false;                                // its publisher is lost, and it may be elsewhere
  std::optional<std::chrono::nanoseconds> age = {};  // of its pose; none: it has not moved since it was added
  std::string why_left_out = {};                     // empty: the filter lets it answer
};

/// Where a ray is nearest to an object that it misses. beside: along the ray; start: at its origin, or behind it; end:
/// at its end
enum class WhereMissed { beside, start, end };

/// An object that the ray misses, or for which the answer is undecided.
struct ExplainedMiss {
  std::string object = {};
  Verdict verdict = Verdict::miss;  // miss or undecided
  double distance_m = 0;            // between ray and object; |truth - distance_m| <= error_m
  double error_m = 0;
  double along_m = 0;  // approximate distance along the ray to the nearest point
  Vec3 on_ray = Vec3::Zero();
  Vec3 on_object = Vec3::Zero();
  double point_error_m = 0;  // of both points
  std::uint32_t triangle = kNoTriangle;
  WhereMissed where = WhereMissed::beside;
  bool box_met = false;           // the ray hits its bounding box, so its parts were candidates
  std::string why_left_out = {};  // empty: the filter lets it answer
};

/// An object of a lost publisher that may now be in the ray's way.
struct ExplainedStale {
  std::string object = {};
  std::chrono::nanoseconds age{0};  // of its last pose
  double from_m = 0;                // the first place along the ray where it may be
};

/// Explanation of a ray's answer.
struct ExplainedRay {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  Rung rung = Rung::filter;                     // the highest that the whole answer needed
  std::uint64_t nodes = 0;                      // index nodes opened
  std::uint64_t exact_tests = 0;                // of parts
  std::uint64_t objects = 0;                    // in the world
  std::uint64_t boxes_met = 0;                  // candidates: objects whose boxes the ray hits and that pass the filter
  std::uint64_t left_out_count = 0;             // objects that the filter leaves out
  std::vector<ExplainedMeeting> met = {};       // each object once, in order along the ray; the first is the answer
  std::vector<ExplainedMeeting> left_out = {};  // filtered objects that the ray hits before the answer
  std::vector<ExplainedMiss> misses = {};       // nearest first, then the one asked for
  std::vector<ExplainedStale> stale = {};
  std::vector<std::string> unknown = {};    // unknown space whose box the ray hits
  std::optional<Uncovered> uncovered = {};  // where the ray leaves the space in which the geometry is complete
  bool cut = false;                         // there are more hits than the limit: `met` lacks some
  bool late = false;                        // the deadline passed: misses may lack nearer ones
  std::chrono::nanoseconds world_time{0};
  std::uint64_t version = 0;
};

// ---- two objects ---------------------------------------------------------------------------------------------------

using codes::ApproachEnd;

/// How near two objects came, also between published poses.
struct ExplainedApproach {
  ApproachEnd end = ApproachEnd::found;
  std::chrono::nanoseconds from{0};  // begin of the interval that was searched
  std::chrono::nanoseconds to{0};    // and its end
  std::chrono::nanoseconds time{0};  // when they were nearest
  double distance_m = 0;             // then; |truth - distance_m| <= error_m. Infinite: nothing was evaluated in time
  double error_m = 0;
  double at_least_m = 0;    // a lower bound on their distance over the whole interval
  std::uint64_t looks = 0;  // distances that were evaluated
};

/// Explanation of a pair: its answer, and why its contacts are not reported.
struct ExplainedPair {
  PairAnswer answer = {};                 // as from Client::pair, without triangles and certificate
  std::vector<std::string> why_not = {};  // why contacts of the two are not reported, a sentence each; empty: they are
  std::string attached = {};              // the one that moves along with the other; empty: neither
  std::optional<ExplainedApproach> nearest = {};
  std::string no_nearest = {};  // why there is none
};

// ---- a standing question ------------------------------------------------------------------------------------------

/// The relation of an object to a region, or to the object or point of a question for the nearest.
struct ExplainedObject {
  std::string object = {};
  /// At the current poses. hit: it is in, or touches; miss: they are apart. It may differ from `reported`, which waits for
  /// the poses of all publishers.
  Verdict verdict = Verdict::miss;
  /// Apart: the distance; in a region: minus the depth. |truth - clearance_m| <= error_m. Infinite: not evaluated.
  double clearance_m = 0;
  double error_m = 0;
  std::optional<Vec3> on_other = {};   // nearest point of the region or the other object, if they are apart
  std::optional<Vec3> on_object = {};  // nearest point of this object, if they are apart
  bool stale = false;                  // its publisher is lost, and it may be elsewhere
  bool reported = false;               // an event has reported that it is in, or the nearest
  std::optional<std::chrono::nanoseconds> since = {};  // if reported: since when
  std::uint64_t episode = 0;                           // if reported: the sequence of that event
  std::string doubt = {};                              // if reported without certainty: why
  std::string why_left_out = {};                       // empty: the question monitors it
};

/// An event of the question that the server remembers.
struct ExplainedNews {
  std::uint64_t sequence = 0;
  std::string what = {};  // enter, exit; nearest, no longer nearest
  std::string object = {};
  std::string why = {};    // of an end: separated, removed, ...
  std::string doubt = {};  // empty: none
  std::chrono::nanoseconds low{0};
  std::chrono::nanoseconds high{0};
};

/// Explanation of a region or of a question for the nearest. For the nearest, clearances are distances to the
/// question's object or point.
struct ExplainedStanding : DefinedStanding {
  bool placed = true;                          // false: the object `to` is missing, so the question monitors nothing
  std::uint64_t looked_at = 0;                 // objects that it monitors
  std::vector<ExplainedObject> holds = {};     // as reported: the objects in the region, deepest first; or the nearest
  std::vector<ExplainedObject> others = {};    // the nearest others that it monitors, also beyond within_m
  std::vector<ExplainedObject> left_out = {};  // in the region or nearer than the nearest, but not monitored
  std::optional<ExplainedObject> asked_for = {};
  std::vector<ExplainedNews> events = {};  // the newest ones that the server remembers
  std::uint64_t cut_short = 0;             // as in ListedStanding
  bool late = false;                       // the deadline passed: some objects were not evaluated
  std::chrono::nanoseconds world_time{0};
  std::uint64_t version = 0;
};

// ---- an event ------------------------------------------------------------------------------------------------------

/// Kinds of events. contacts: of Client::watch. standing: of standing questions
enum class EventsOf { contacts, standing };

/// One of the two objects of an event, at the time by which it had happened.
struct ExplainedBody {
  std::string object = {};
  bool remembered = false;  // false: its place at that time is forgotten, and the members below are not set
  bool moving = false;
  std::string publisher = {};  // empty: the server's own, or without a name
  Pose pose = {};
  /// Times of the two poses around the change; none: it was at rest, or the poses are forgotten.
  std::optional<std::chrono::nanoseconds> motion_from = {};
  std::optional<std::chrono::nanoseconds> motion_to = {};
};

/// The clearance of the two at an end of the bracket.
struct ExplainedGap {
  std::chrono::nanoseconds time{0};
  Verdict verdict = Verdict::miss;  // hit: they touched
  double clearance_m = 0;           // apart: the distance; else minus the depth; |truth - clearance_m| <= error_m
  double error_m = 0;
};

/// The data behind an event that was reported.
struct ExplainedEvent {
  std::uint64_t sequence = 0;
  EventsOf of = EventsOf::contacts;
  std::string what = {};   // began, ended, ...; for standing questions enter, exit, nearest, no longer nearest
  std::string why = {};    // of an end: separated, removed, ...
  std::string doubt = {};  // empty: none
  std::string a = {};
  std::string b = {};
  std::string margin = {};                 // for bands: the question's name; `b` is the object that has the band
  std::string within = {};                 // for bands: the band, in metres
  std::uint32_t a_triangle = kNoTriangle;  // as in Event, and so are the members up to `began`
  std::uint32_t b_triangle = kNoTriangle;
  double depth_m = 0;
  double error_m = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  std::uint64_t episode = 0;
  std::chrono::nanoseconds began{0};
  std::chrono::nanoseconds low{0};  // the change happened between low and high
  std::chrono::nanoseconds high{0};
  std::vector<std::string> why_wide = {};   // why low and high are far apart, a sentence each
  std::vector<ExplainedBody> bodies = {};   // a and b
  std::optional<ExplainedGap> before = {};  // at `low`, for contacts whose poses are remembered
  std::optional<ExplainedGap> after = {};   // at `high`
  std::chrono::nanoseconds world_time{0};   // of the step that detected it
  std::uint64_t version = 0;
};

}  // namespace collided

#pragma GCC visibility pop
