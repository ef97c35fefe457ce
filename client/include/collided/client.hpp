#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <collided/certificate.hpp>

/// The client of a collision server: ask, watch, and move objects. Metres, seconds, right-handed; quaternions w first.
/// Threads: every class here may be used from any thread, one call at a time per object unless said otherwise.
#pragma GCC visibility push(default)

namespace collided {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

// ---- results -------------------------------------------------------------------------------------------------------

enum class ErrorCode { bad_input, no_server, timeout, refused, disconnected, internal };

/// What went wrong and what to do next, ready to print.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
  std::string hint;  // may be empty
};

/// A value or the error that stands in its place.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}
  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() { return std::get<0>(state_); }
  const T& operator*() const { return std::get<0>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value, or the error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}
  explicit operator bool() const { return !error_; }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

// ---- questions -----------------------------------------------------------------------------------------------------

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
struct NearQuestion {
  Vec3 point;
  double within_m = std::numeric_limits<double>::infinity();
};
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();
};
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
  HitMode mode = HitMode::closest;          // rays only
  std::uint32_t mask = 0xffffffff;    // layers that may answer
  std::string only = {};              // name glob (* ? [...]), empty: everything
  std::string skip = {};              // name glob, empty: nothing
  std::uint32_t max_hits = 1000;      // per question; more are cut and the answer is undecided (truncated)
  double error_m = 0;                 // error asked; 0: exact on doubt
  std::chrono::nanoseconds deadline{0};             // 0: none; later answers are undecided (deadline)
  std::chrono::nanoseconds timeout{2'000'000'000};  // how long the caller waits
  bool fresh = false;                 // answer after this connection's own last write
  Instant as_of = {};                 // Answers::world_time says which instant it was
  Importance importance = Importance::normal;
};

enum class Verdict { miss, hit, undecided, invalid };
enum class UndecidedReason { none, numeric, stale_object, recovering, truncated, deadline, not_covered };

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

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
  bool inside = false;
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

// ---- pairs of objects ----------------------------------------------------------------------------------------------

struct PairOptions {
  bool certificate = false;
  bool triangles = false;
  std::uint32_t most_triangle_pairs = 10'000;  // that are told, at most 100,000
  Instant as_of = {};                          // both at one instant; latest: each at its newest pose
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

enum class Containment { none, a_in_b, b_in_a };

/// How two objects stand to each other in one state of the world. hit: they share a point; depth_m is the shortest way
/// that parts the two parts that overlap deepest (a part is a triangle or a primitive), along the normal. miss: the
/// distance, with a point of each that has about that distance from the other. With the names the other way round the
/// numbers are the same, and the normal is turned round.
struct PairAnswer {
  Verdict verdict = Verdict::miss;
  UndecidedReason reason = UndecidedReason::none;  // numeric: both answers are consistent with the input; stale_object: see stale
  /// One of the two moved when it was last heard of (its publisher is lost, or has not come to the instant asked for): the
  /// numbers are those of where it was then. A miss is said only where it cannot have come to the other since.
  bool stale = false;
  std::uint64_t version = 0;
  Vec3 normal = Vec3::Zero();     // unit, from a to b
  double distance_m = 0;          // miss; |truth - distance_m| <= error_m
  double depth_m = 0;             // hit; |truth - depth_m| <= error_m
  double error_m = 0;
  Vec3 on_a = Vec3::Zero();       // miss; within point_error_m of a
  Vec3 on_b = Vec3::Zero();
  double point_error_m = 0;
  Vec3 point = Vec3::Zero();      // hit; in the middle of the deepest overlap
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
};

// ---- probes --------------------------------------------------------------------------------------------------------

/// A ray fixed to an object, such as one under each wheel. It looks along the direction from back_m behind the origin to
/// reach_m ahead of it, and its clearance is the signed distance from the origin to the first thing that it meets there,
/// of what the object itself may meet: above 0 a gap, 0 touching, below 0 a collision.
struct Probe {
  std::string name;    // unique in the server
  std::string object;  // by name; it need not be there yet
  Vec3 origin = Vec3::Zero();  // in the object's frame
  Vec3 direction = -Vec3::UnitZ();
  double reach_m = 10;
  double back_m = 1;
};

/// absent: the object is not in the world. deeper: the ray begins inside a solid, the clearance is at most -back_m.
enum class Clearance { absent, nothing, gap, touching, collision, deeper, undecided };

struct ProbeReading {
  std::string probe;
  std::string object;  // empty where it is absent
  Clearance state = Clearance::absent;
  double clearance_m = 0;  // |truth - clearance_m| <= error_m; the sign is exact
  double error_m = 0;
  std::string met;
  std::uint32_t triangle = kNoTriangle;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::chrono::nanoseconds world_time{0};
};

/// Readings of every probe after every step, from when it was made on.
class ProbeWatch {
 public:
  ~ProbeWatch();
  ProbeWatch(ProbeWatch&&) noexcept;
  ProbeWatch& operator=(ProbeWatch&&) noexcept;

  /// The next reading; nothing after `wait`.
  std::optional<ProbeReading> next(std::chrono::nanoseconds wait);
  /// Readings dropped because nobody called next().
  std::uint64_t lost() const;

 private:
  friend class Client;
  struct State;
  explicit ProbeWatch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// ---- events --------------------------------------------------------------------------------------------------------

enum class EventKind { open, began, persisted, ended };
enum class EndReason { none, separated, removed, publisher_lost, teleported, geometry_changed, server_stopping, server_restarted, decided };
/// Why it is not known whether two objects touch: the test came out undecided; the way between two poses could not be
/// followed to its end; one of them is where a lost publisher (LostPolicy::freeze) said last.
enum class Doubt { none, numeric, cost_limit, publisher_lost };

struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  /// Else the pair is not known to touch nor to be apart, from its `began` to its `ended`; there is no point, normal or depth.
  Doubt doubt = Doubt::none;
  bool resync = false;  // learnt from the contact state after a gap, a late start or a new server
  std::string a;
  std::string b;
  std::uint64_t a_id = 0;
  std::uint64_t b_id = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
  std::uint64_t episode = 0;  // sequence of the pair's `began`
  std::chrono::nanoseconds world_time{0};
  std::chrono::nanoseconds began{0};     // world time at which the episode began
  double bracket_low_s = 0;              // the change happened between these, seconds before world_time
  double bracket_high_s = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();            // from a to b
  double depth_m = 0;
  double depth_error_m = 0;
  /// Of b relative to a at the point, m/s, from the last two poses of each; resting are objects that are new, were
  /// teleported or have been silent. Zero but for `began` and `persisted`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // |truth - relative_velocity| <= velocity_error; infinite in recordings of before 0.2
};

/// World time by which the change of an event had happened: the end of its bracket. Others may be told before it that
/// happened later, for each pair waits until both of its publishers are known.
inline std::chrono::nanoseconds happened(const Event& event) {
  return event.world_time - std::chrono::nanoseconds(std::llround(event.bracket_high_s * 1e9));
}

/// From when the two first touched to when they had parted, of an `ended`.
inline std::chrono::nanoseconds lasted(const Event& ended) { return happened(ended) - ended.began; }

struct WatchOptions {
  std::string only = {};       // either name must match; empty: everything
  std::string skip = {};       // neither name may match
  bool persisted = false;
  std::size_t capacity = 65'536;  // of the poll queue; beyond it the oldest are dropped and counted
  /// Since 1970. What held then comes first as `open`, then what has happened since by the server's flight recorder, then what
  /// comes. Refused where the server keeps none.
  std::optional<std::chrono::nanoseconds> since = {};
};

/// Events of every pair, each once and in order; on a gap or a new server only the differences come, marked `resync`.
/// The first events are `open`: what already holds. Destroying it (not from its own callback) ends the watching.
class Watch {
 public:
  ~Watch();
  Watch(Watch&&) noexcept;
  Watch& operator=(Watch&&) noexcept;

  /// The next event; nothing after `wait`.
  std::optional<Event> next(std::chrono::nanoseconds wait);
  std::uint64_t lost() const;      // events dropped because nobody called next()
  std::uint64_t resyncs() const;
  /// False while no status has come for 240 ms.
  bool connected() const;
  /// The server has vouched for what this watch knows: what held when it began has been told as `open`, what comes from now on is
  /// new. False again while something missed is made up for.
  bool in_step() const;
  /// Contacts that hold now by this watch's own account.
  std::size_t open_contacts() const;
  /// With WatchOptions::since: from when on this watch tells events, later than asked for where the flight recorder does not
  /// reach back that far. Else 0.
  std::chrono::nanoseconds tells_since() const;

 private:
  friend class Client;
  struct State;
  explicit Watch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// ---- objects -------------------------------------------------------------------------------------------------------

struct SphereShape {
  double radius_m = 0;
  Vec3 center = Vec3::Zero();
};
struct BoxShape {
  Vec3 half_m = Vec3::Zero();
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();
};
struct CapsuleShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double radius_m = 0;
};
/// Between the planes across a b at its ends; a != b.
struct CylinderShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::UnitZ();
  double radius_m = 0;
};
/// The radius is that of the base, across the way from the apex; apex != base.
struct ConeShape {
  Vec3 apex = Vec3::UnitZ();
  Vec3 base = Vec3::Zero();
  double radius_m = 0;
};
struct EllipsoidShape {
  Vec3 half_m = Vec3::Ones();  // all above 0
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();
};
/// The convex hull of up to 4,096 points that are not all in one plane.
struct HullShape {
  std::vector<Vec3> points;
};
struct MeshShape {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Everything behind a plane: normal . (x - point) <= 0. Alone in its shape, of an object that does not move.
struct HalfSpaceShape {
  Vec3 normal = Vec3::UnitZ();  // any length from 1e-30 to 1e30
  Vec3 point = Vec3::Zero();
};
/// A surface over a grid, row after row of heights along x from the origin on; two triangles a cell. Counts as a mesh.
struct HeightFieldShape {
  std::uint32_t columns = 0;
  double spacing_x_m = 1;
  double spacing_y_m = 1;
  std::vector<double> heights_m;  // whole rows, at least 2 of 2
};
/// Balls about points, with an index of its own.
struct CloudShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};
/// Capsules from each point to the next, at least 2 points; with an index of its own.
struct PolylineShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};

/// One part, or several that move as one. At most one of them a mesh or height field.
using ShapePart = std::variant<SphereShape, BoxShape, CapsuleShape, MeshShape, CylinderShape, ConeShape, EllipsoidShape,
                               HullShape, HalfSpaceShape, HeightFieldShape, CloudShape, PolylineShape>;
using Shape = std::vector<ShapePart>;

/// What becomes of an object whose publisher is lost.
enum class LostPolicy { remove, freeze, hold };

struct ObjectOptions {
  std::string name = {};  // unique in the world, at most 255 bytes
  Shape shape = {};
  /// About the object's origin, above 0. Factors that differ suit meshes, height fields, hulls, and boxes and ellipsoids
  /// along the axes; for the other kinds they are refused.
  Vec3 scale = Vec3::Ones();
  Pose pose = {};
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  std::uint32_t group = 0;  // members of one group other than 0 never meet
  bool moving = true;
  LostPolicy lost_policy = LostPolicy::remove;
};

/// A source of objects and their poses. Objects live as long as the publisher unless removed earlier.
/// Poses are collected by move() and sent by flush() as batches of at most 4,096.
/// Only its calls say that it lives, so that a thread that hangs is noticed: after 500 ms without one the server takes it
/// for lost (ObjectOptions::when_lost). The next call then defines all its objects anew, at their newest poses.
class Publisher {
 public:
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  using Object = std::uint32_t;
  Result<Object> add(const ObjectOptions& options);
  Result<void> remove(Object object);
  /// Non-finite or non-unit (beyond 1e-6) poses are refused.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// Sends what move() collected; returns the sequence of the last message (for AskOptions.fresh). It says where everything
  /// is at that time: what was not moved since the flush before has rested, also where nothing was. Pairs with other
  /// publishers' objects are decided up to there, so who has nothing to move flushes all the same.
  /// source_time: of the poses, since 1970; 0: now. One before an earlier flush's counts as the nanosecond after it. On a
  /// timeout what was not sent stays collected.
  Result<std::uint64_t> flush(std::chrono::nanoseconds source_time = {});
  /// From now on each object moves between its own poses, whichever others a flush names: for sources whose objects have
  /// instants of their own. Who is not moved for 250 ms has rested until 250 ms before its next pose.
  void stream();
  /// Says "still there" without moving anything; move/flush say so as well.
  Result<void> keep_alive();
  /// Waits until the server has applied everything sent so far.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);

 private:
  friend class Client;
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// ---- what is where -------------------------------------------------------------------------------------------------

/// Bits of an edge's kind. Decided exactly, by the server.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,  // of one triangle only
  kManyEdge = 2,      // of three and more
  kCreaseEdge = 4,    // of two that meet at more than the asked angle
  kMaterialEdge = 8,  // of triangles of different parts of a scene, which are what its file's materials and groups became
  kTurnedEdge = 16,   // of two that run along it the same way: one counts as turned over
};

/// ends       vertex numbers; places that vertices share have one number, the first
/// triangles  the first two that have the edge; kNoTriangle: there is no second
struct SurfaceEdge {
  std::array<std::uint32_t, 2> ends{};
  std::array<std::uint32_t, 2> triangles{};
  std::uint8_t kinds = 0;
};

/// Triangles as the server has them, in the frame of what they are of, in the very doubles that decide; immutable.
struct Surface {
  std::uint64_t number = 0;  // the server's, of its epoch; another surface never has it
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<SurfaceEdge> edges;  // of all triangles with an area; empty unless they were asked for
};

/// A run of a surface's triangles: many objects may share one surface, and the parts of a scene have one each of theirs.
struct SurfaceRun {
  std::shared_ptr<const Surface> surface;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  bool is_hull = false;  // closed, its triangles outward, and the inside counts too
};

/// An object as it stands. The parts are spheres, boxes, capsules, cylinders, cones, ellipsoids and half-spaces, clouds
/// and lines as the balls and capsules that they are; everything else is runs of surfaces. All in the object's own frame,
/// scaled already; parts of a static scene in world coordinates, with no pose. Turned boxes and ellipsoids have their axes
/// as a quaternion, off by some 1e-16.
struct ShownObject {
  std::uint64_t id = 0;
  std::string name;
  std::string scene;  // that it was loaded with; empty: added at run time
  bool moving = false;
  bool stale = false;  // its publisher is lost
  std::uint32_t layers = 0;
  std::uint32_t mask = 0;
  std::uint32_t group = 0;
  Pose pose;  // the newest
  Shape parts;
  std::vector<SurfaceRun> runs;
};

/// Objects of one state of the world.
struct ShownObjects {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::uint64_t table_version = 0;  // changes when an object comes, goes or gets another shape
  std::chrono::nanoseconds world_time{0};
  std::vector<ShownObject> objects;
};

struct ShapesOptions {
  std::string only = {};  // name globs, as in AskOptions
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;
  std::optional<bool> moving = {};   // only what moves, or only what does not
  bool edges = false;                // of surfaces, with their kinds
  double crease_cosine = 0.5;        // of the angle between two normals beyond which their edge is a crease
  std::chrono::nanoseconds timeout{10'000'000'000};  // of each page of 8 MiB
};

/// Where everything that moves is, in one state of the world; parallel.
struct Poses {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::uint64_t table_version = 0;  // other than that of the ShownObjects at hand: ask for shapes again
  std::chrono::nanoseconds world_time{0};
  std::vector<std::uint64_t> ids;
  std::vector<Pose> poses;
  std::vector<std::uint8_t> stale;  // 1: its publisher is lost
};

// ---- connection ----------------------------------------------------------------------------------------------------

struct PublisherInfo {
  std::string name;
  std::uint64_t applied_sequence = 0;
  std::chrono::nanoseconds silent{0};
  bool lost = false;
};

struct ServerStatus {
  std::string name_space;
  std::string version_text;
  std::uint32_t pid = 0;
  std::string state;  // starting, recovering, ready, stopping
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::chrono::nanoseconds world_time{0};
  std::uint64_t last_event_sequence = 0;
  std::uint32_t contacts = 0;
  bool contacts_truncated = false;  // there are more than the server may tell (its max_contacts)
  std::vector<std::string> scenes;
  std::uint64_t static_triangles = 0;
  std::uint32_t objects = 0;
  std::uint32_t moving = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_dropped = 0;
  std::uint64_t questions_answered = 0;
  std::uint64_t questions_refused = 0;
  std::uint64_t undecided_answers = 0;
  std::vector<PublisherInfo> publishers;
  std::chrono::nanoseconds age{0};  // of this status
};

struct ConnectOptions {
  int domain = 0;  // 0 to 230
  std::string name_space = "collided";
  std::string interface = "lo";  // "auto" opens it to the network
  std::vector<std::string> peers = {};
  std::chrono::nanoseconds wait{2'000'000'000};  // for a server to answer

  /// As the command line has it: COLLIDED_DOMAIN (else ROS_DOMAIN_ID), COLLIDED_NAMESPACE, COLLIDED_INTERFACE where they are
  /// set, the above where not. Error bad_input for a domain that is none.
  /// variable  what a variable says, empty where it is not set; none: the process's own environment
  static Result<ConnectOptions> from_environment(const std::function<std::string(const char* name)>& variable = {});
};

/// A connection to one server. Calls may come from several threads at once.
class Client {
 public:
  /// Waits until a server answers hello; Error no_server otherwise, with what was seen on the domain.
  static Result<Client> connect(const ConnectOptions& options);
  /// To where the environment says.
  static Result<Client> connect();
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  Result<Answer> ask(const RayQuestion& question, const AskOptions& options = {});
  Result<Answer> ask(const SphereQuestion& question, const AskOptions& options = {});
  Result<Answer> ask(const BoxQuestion& question, const AskOptions& options = {});
  Result<Answer> ask(const NearQuestion& question, const AskOptions& options = {});

  /// Up to 100,000 questions on one state of the world.
  Result<Answers> ask(std::span<const RayQuestion> questions, const AskOptions& options = {});
  Result<Answers> ask(std::span<const SphereQuestion> questions, const AskOptions& options = {});
  Result<Answers> ask(std::span<const BoxQuestion> questions, const AskOptions& options = {});
  Result<Answers> ask(std::span<const NearQuestion> questions, const AskOptions& options = {});

  /// The same; the answers of an earlier batch lend their memory, which saves a third of what a batch of rays costs here.
  Result<Answers> ask(std::span<const RayQuestion> questions, const AskOptions& options, Answers&& earlier);
  Result<Answers> ask(std::span<const SphereQuestion> questions, const AskOptions& options, Answers&& earlier);
  Result<Answers> ask(std::span<const BoxQuestion> questions, const AskOptions& options, Answers&& earlier);
  Result<Answers> ask(std::span<const NearQuestion> questions, const AskOptions& options, Answers&& earlier);

  /// The first contact of a shape on each of up to 100,000 ways, with everything as it is in one state of the world: a hit
  /// in the answer; a miss: the way is free. undecided: what is met could not be followed to the end of the way.
  Result<Answers> sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options = {});

  /// Two objects by name: touching and how deep, or apart and how far; the rest as the options ask for it.
  Result<PairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});

  std::future<Result<Answers>> ask_async(std::vector<RayQuestion> questions, AskOptions options = {});
  std::future<Result<Answers>> ask_async(std::vector<SphereQuestion> questions, AskOptions options = {});
  std::future<Result<Answers>> ask_async(std::vector<BoxQuestion> questions, AskOptions options = {});
  std::future<Result<Answers>> ask_async(std::vector<NearQuestion> questions, AskOptions options = {});

  /// Poll with Watch::next.
  Result<Watch> watch(const WatchOptions& options = {});
  /// Calls back from a thread of the library until the Watch is destroyed.
  Result<Watch> watch(const WatchOptions& options, std::function<void(const Event&)> callback);

  /// Replaces a probe of that name. The server keeps it until it is removed, whoever comes and goes.
  Result<void> add_probe(const Probe& probe);
  /// By name or glob; how many there were.
  Result<std::size_t> remove_probes(const std::string& name);
  /// Every probe's reading in the newest state.
  Result<std::vector<ProbeReading>> probes(const std::string& name_glob = {});
  Result<ProbeWatch> watch_probes(const WatchOptions& options = {});

  /// What is where, with every shape: for whoever draws. A surface that many share comes once. Where objects come and go
  /// faster than their surfaces are fetched, those that have gone by then are left out.
  ///
  /// earlier  what the same options gave before: its surfaces are not fetched again; may be null
  /// limits   512 MiB of one surface (12 M triangles with their edges) or of all objects; beyond them it is refused
  Result<ShownObjects> shapes(const ShapesOptions& options = {}, const ShownObjects* earlier = nullptr);
  /// Up to 400,000 objects; one message for 3,500 of them and less.
  Result<Poses> poses(std::chrono::nanoseconds timeout = std::chrono::seconds(2));

  Result<Publisher> publish(const std::string& publisher_name);

  /// Commands (load, add, move, remove, clear, list, get, plan, ...): JSON in, JSON out.
  /// progress is called with a fraction in [0, 1] from the calling thread; each call starts the timeout anew.
  Result<std::string> command(std::string_view name, std::string_view json_arguments,
                              const Shape& shape = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                              std::function<void(double)> progress = {});

  /// Sends a file's bytes, for a server that cannot read the file itself, and has them loaded as a scene: the server reads
  /// them in a process that may do nothing else. file_name: letters, digits, dot, dash and underscore, with the ending that says
  /// the format; json_arguments and the answer: those of the command load. A file that names other files comes without them.
  /// progress is called with a fraction in [0, 1]: of what is sent up to a half, then of what is read; the timeout is for each
  /// step of it. Up to 1 GiB.
  Result<std::string> upload(std::span<const std::byte> bytes, std::string_view file_name, std::string_view json_arguments = {},
                             std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                             std::function<void(double)> progress = {});

  /// The newest status heard.
  Result<ServerStatus> status();

 private:
  struct State;
  explicit Client(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// "0.1.0"
std::string_view library_version();

}  // namespace collided

#pragma GCC visibility pop
