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

/// Why an answer is what it is, and not another one: of a ray, of two objects, of a fence, of an event. Metres, world
/// coordinates; times are world times since 1970. The server fills these structs; as JSON they have the names that
/// idl/answers/explanation.hpp lists.
#pragma GCC visibility push(default)

namespace collided {

/// How an explanation is asked for.
struct ExplainOptions {
  std::uint32_t mask = 0xffffffff;  // rays: as of AskOptions, and so are the next two
  std::string only = {};
  std::string skip = {};
  Instant as_of = {};                    // rays and pairs: of all objects; latest: each at its newest pose
  std::string why_not = {};              // rays, fences, the nearest: an object that is reported in any case
  std::uint32_t most = 3;                // the same: misses, objects outside or farther away that are reported
  std::chrono::nanoseconds last{0};      // pairs: how far back their paths are looked at; 0: all of memory
  std::chrono::nanoseconds deadline{0};  // on the server, which then returns what it has; 0: none but the timeout
  std::chrono::nanoseconds timeout{10'000'000'000};  // for the answer
};

// ---- a ray ---------------------------------------------------------------------------------------------------------

/// The arithmetic that a decision needed.
enum class Rung { filter, expansion, rational };

/// An object that the ray meets.
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
  std::optional<std::chrono::nanoseconds> age = {};  // of its pose; none: it has stood since it was added
  std::string why_left_out = {};                     // empty: the filter lets it answer
};

/// miss: the ray passes it. beside: along the ray; start: nearest to its origin, beside it or behind; end: its length ends there
enum class WhereMissed { beside, start, end };

/// An object that the ray does not meet, or of which that is open.
struct ExplainedMiss {
  std::string object = {};
  Verdict verdict = Verdict::miss;  // or undecided
  double distance_m = 0;            // the least of any two points of ray and object; |truth - distance_m| <= error_m
  double error_m = 0;
  double along_m = 0;  // where on the ray that is, about
  Vec3 on_ray = Vec3::Zero();
  Vec3 on_object = Vec3::Zero();
  double point_error_m = 0;  // of both points
  std::uint32_t triangle = kNoTriangle;
  WhereMissed where = WhereMissed::beside;
  bool box_met = false;           // the ray meets its bounding box, so its parts were candidates
  std::string why_left_out = {};  // empty: the filter lets it answer
};

/// An object whose publisher is lost, and that may be in the ray's way by now.
struct ExplainedStale {
  std::string object = {};
  std::chrono::nanoseconds age{0};  // of its last pose
  double from_m = 0;                // where along the ray that may be, at the earliest
};

/// Why a ray meets what it meets.
struct ExplainedRay {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;
  Rung rung = Rung::filter;                     // the highest that the whole answer needed
  std::uint64_t nodes = 0;                      // boxes of the indexes that were opened
  std::uint64_t exact_tests = 0;                // of parts
  std::uint64_t objects = 0;                    // in the world
  std::uint64_t boxes_met = 0;                  // of objects that may answer: the candidates
  std::uint64_t left_out_count = 0;             // objects that the filter leaves out
  std::vector<ExplainedMeeting> met = {};       // each object once, in order along the ray; the first is the answer
  std::vector<ExplainedMeeting> left_out = {};  // would have come before the answer but for the filter
  std::vector<ExplainedMiss> misses = {};       // nearest first, then the one asked for
  std::vector<ExplainedStale> stale = {};
  std::vector<std::string> unknown = {};    // unknown space whose box the ray meets
  std::optional<Uncovered> uncovered = {};  // where the ray leaves the space in which the geometry is complete
  bool cut = false;                         // there are more hits than are looked at: `met` lacks some
  bool late = false;                        // the deadline was over: misses may lack nearer ones
  std::chrono::nanoseconds world_time{0};
  std::uint64_t version = 0;
};

// ---- two objects ---------------------------------------------------------------------------------------------------

using codes::ApproachEnd;

/// How near two objects came on their ways, not only at the poses that were sent.
struct ExplainedApproach {
  ApproachEnd end = ApproachEnd::found;
  std::chrono::nanoseconds from{0};  // the stretch that was looked at
  std::chrono::nanoseconds to{0};
  std::chrono::nanoseconds time{0};  // when they were nearest
  double distance_m = 0;             // then; |truth - distance_m| <= error_m. Infinite: nothing was looked at in time
  double error_m = 0;
  double at_least_m = 0;    // at no time of the stretch were they nearer
  std::uint64_t looks = 0;  // distances that it took
};

/// How two objects stand to each other, and why contacts of them are not reported.
struct ExplainedPair {
  PairAnswer answer = {};  // as Client::pair gives it, without triangles and certificate
  std::vector<std::string> why_not =
      {};                     // what keeps contacts of the two from being reported, a sentence each; empty: they are
  std::string attached = {};  // the one that moves along with the other; empty: neither
  std::optional<ExplainedApproach> nearest = {};
  std::string no_nearest = {};  // why there is none
};

// ---- a standing question ------------------------------------------------------------------------------------------

/// How an object stands to a region, or to what a question for the nearest is about.
struct ExplainedObject {
  std::string object = {};
  /// Where both are now: hit: it is in, or touches; miss: they are apart. It may differ from `reported`, which is as far as
  /// all publishers have said where their objects are.
  Verdict verdict = Verdict::miss;
  /// Apart: the distance; in a region: minus the depth. |truth - clearance_m| <= error_m. Infinite: not looked at.
  double clearance_m = 0;
  double error_m = 0;
  std::optional<Vec3> on_other = {};   // the nearest points of two that are apart: of the region or the other object,
  std::optional<Vec3> on_object = {};  // and of this one
  bool stale = false;                  // its publisher is lost, and it may be elsewhere
  bool reported = false;               // an event has reported that it is in, or the nearest
  std::optional<std::chrono::nanoseconds> since = {};  // of reported: since when
  std::uint64_t episode = 0;                           // of reported: the sequence of that event
  std::string doubt = {};                              // of reported: why it was, although that is not known
  std::string why_left_out = {};                       // empty: the question looks at it
};

/// An event of the question that is remembered.
struct ExplainedNews {
  std::uint64_t sequence = 0;
  std::string what = {};  // enter, exit; nearest, no longer nearest
  std::string object = {};
  std::string why = {};    // of an end: separated, removed, ...
  std::string doubt = {};  // empty: none
  std::chrono::nanoseconds low{0};
  std::chrono::nanoseconds high{0};
};

/// A region or a question for the nearest. Of the nearest, clearances are distances to what the question is about.
struct ExplainedStanding : DefinedStanding {
  bool placed = true;                          // false: the object `to` is not there, so the question looks at nothing
  std::uint64_t looked_at = 0;                 // objects
  std::vector<ExplainedObject> holds = {};     // what was reported: in the region, the deepest first; or the nearest
  std::vector<ExplainedObject> others = {};    // the nearest others that it looks at, also beyond within_m
  std::vector<ExplainedObject> left_out = {};  // in the region or nearer than the nearest, and not looked at
  std::optional<ExplainedObject> asked_for = {};
  std::vector<ExplainedNews> events = {};  // the last that are remembered
  std::uint64_t cut_short = 0;             // as in ListedStanding
  bool late = false;                       // the deadline was over: some were not looked at
  std::chrono::nanoseconds world_time{0};
  std::uint64_t version = 0;
};

// ---- an event ------------------------------------------------------------------------------------------------------

/// contacts: of Client::watch. standing: of standing questions
enum class EventsOf { contacts, standing };

/// One of the two of an event, at the time by which it had happened.
struct ExplainedBody {
  std::string object = {};
  bool remembered = false;  // false: where it was then is not known any more, and nothing below
  bool moving = false;
  std::string publisher = {};  // empty: the server's own, or without a name
  Pose pose = {};
  /// The two poses between which the change lies; none: it was at rest, or that is not remembered.
  std::optional<std::chrono::nanoseconds> motion_from = {};
  std::optional<std::chrono::nanoseconds> motion_to = {};
};

/// How the two stood to each other at an end of the bracket.
struct ExplainedGap {
  std::chrono::nanoseconds time{0};
  Verdict verdict = Verdict::miss;  // hit: they touched
  double clearance_m = 0;           // apart: the distance, else minus the depth; |truth - clearance_m| <= error_m
  double error_m = 0;
};

/// The data behind an event that was reported.
struct ExplainedEvent {
  std::uint64_t sequence = 0;
  EventsOf of = EventsOf::contacts;
  std::string what = {};   // began, ended, ...; of standing questions enter, exit, nearest, no longer nearest
  std::string why = {};    // of an end: separated, removed, ...
  std::string doubt = {};  // empty: none
  std::string a = {};
  std::string b = {};
  std::string margin = {};                 // of bands: the question's name, and `b` is the object that has the band
  std::string within = {};                 // and the band, in metres
  std::uint32_t a_triangle = kNoTriangle;  // as in Event, and so are the members up to `began`
  std::uint32_t b_triangle = kNoTriangle;
  double depth_m = 0;
  double error_m = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  std::uint64_t episode = 0;
  std::chrono::nanoseconds began{0};
  std::chrono::nanoseconds low{0};  // the change happened between these two
  std::chrono::nanoseconds high{0};
  std::vector<std::string> why_wide = {};   // why these two are so far apart, a sentence each
  std::vector<ExplainedBody> bodies = {};   // a and b
  std::optional<ExplainedGap> before = {};  // at `low`; of contacts whose places then are remembered
  std::optional<ExplainedGap> after = {};   // at `high`
  std::chrono::nanoseconds world_time{0};   // of the step that found it
  std::uint64_t version = 0;
};

}  // namespace collided

#pragma GCC visibility pop
