#include "server/world/objects/swept_object.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "server/exact_phase/motion/ground_motion.hpp"
#include "server/exact_phase/motion/part_motion_filter.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/scene_touch.hpp"

namespace collided::engine {
namespace {

/// A piece of the motion with no more pairs than this is not cut again; pairs of two meshes cost more to list, so more
/// are allowed.
constexpr std::size_t kPairsAPiece = 8;
constexpr std::size_t kMeshPairsAPiece = 24;
/// A piece with up to this factor more pairs is also not cut if the previous cut left most of them: the box of a long
/// part holds many triangles of a mesh that are not near it.
constexpr std::size_t kManyPairs = 8;
constexpr std::size_t kUnknownCount = std::numeric_limits<std::size_t>::max();
/// A piece is also not cut if nothing moves farther in it than this share of the smaller body: cutting separates
/// nothing more.
constexpr double kShortPiece = 0x1p-6;
/// This many pairs take the filter as long as testing one pair at one time.
constexpr std::uint32_t kFilteredALook = 8;
constexpr double kShortestPiece = 0x1p-40;  // fraction of the whole motion; bisecting further gains nothing

/// A part of each body that may meet in a piece of the motion: a triangle's number, or 0 for the current primitive.
struct PartPair {
  std::uint32_t a;
  std::uint32_t b;
  auto operator<=>(const PartPair&) const = default;  // NOLINT(modernize-use-nullptr): it compares with 0
};

/// A piece of a body's motion, kept for the next pair.
struct PieceOfBody {
  std::optional<kernel::MotionPiece> piece;
  const BodyMotion* motion = nullptr;
  TimeSpan span;
};

/// The part on a piece of its motion; nothing if the filter does not know its kind.
std::optional<kernel::MovingCore> moving_core(const PartMotion& part, const kernel::MotionPiece& piece) {
  return std::visit(
      [&](const auto& own) -> std::optional<kernel::MovingCore> {
        if constexpr (std::is_constructible_v<kernel::Core, decltype(own)>)
          return piece.moving(own, *part.motion, part.reach_m, part.placing_m);
        else return std::nullopt;
      },
      part.own);
}

/// The search for the first contacts of two bodies. Parts of a are its primitives and triangles; b has triangles, or is
/// tested one primitive at a time.
class SweptSearch {
 public:
  /// origin  from which both are seen; points of contacts found are in world coordinates
  SweptSearch(const SweptBody& a, const SweptBody& b, const Vec3& origin, const SweepOptions& options, WalkCost& cost,
              SweptContactOf touch_of)
      : a_(a), b_(b), origin_(origin), options_(options), cost_(cost), contact_of_(touch_of) {}

  /// Every triangle of b belongs to the same touch.
  bool is_one = false;

  void count_looks() const {
    if (options_.looks != nullptr) *options_.looks += std::min(looks_, options_.most_looks);
  }
  bool is_exhausted() const { return looks_ >= options_.most_looks || is_late(); }

  /// Tests all of a against all of b; touch_of gets b's triangles, and kNoTriangle for its primitives.
  void run();

 private:
  template <class Near>
  void look(const TimeSpan& span, std::size_t few, std::size_t before, double motion_m, double size_m, const Near& near,
            const auto& meet);
  void meet(const PartMotion& a, std::uint32_t a_triangle, const PartMotion& b, std::uint32_t b_triangle,
            TimeSpan span);
  /// The part of the span in which a contact would come before the known one; empty if there is none.
  TimeSpan still_open(std::uint32_t b_triangle, TimeSpan span) const {
    const SweptContact* touch = contact_of_(b_triangle);
    if (touch == nullptr) return {1, 0};
    if (touch->yes) span.high = std::min(span.high, touch->bracket.high);
    return span;
  }
  static const kernel::MotionPiece& piece_of(PieceOfBody& kept, const BodyMotion& motion, const TimeSpan& span);
  void meet_ground(const SweptBody& body, const SweptBody& holder, const Primitive& ground, bool ground_is_a);
  void primitive_and_mesh(const PartMotion& primitive, const SweptBody& other, bool primitive_is_a);
  void visit_near(const BoundedPart& part, const Vec3& motion, const SweptBody& other, const Frame& frame,
                  Bvh::BoxCandidate candidate);
  /// True if a filter in plain double excludes any contact within the span.
  bool is_apart(const PartMotion& primitive, const SweptBody& other, const Triangle& triangle, const TimeSpan& span);
  void meshes();
  void count_filtered() { looks_ += ++filtered_ % kFilteredALook == 0 ? 1 : 0; }
  bool is_late() const { return options_.deadline != nullptr && options_.deadline->is_over(); }
  bool is_settled(std::uint32_t b_triangle, const TimeSpan& span) const {
    const SweptContact* touch = contact_of_(b_triangle);
    return touch == nullptr || (touch->yes && touch->bracket.high <= span.low);
  }
  static bool has_mesh(const SweptBody& body) { return body.mesh != nullptr && !body.mesh->triangles.empty(); }
  static kernel::MovingCore core_of(const SweptBody& body, const Triangle& triangle, const kernel::MotionPiece& piece) {
    return piece.moving(triangle, body.motion, body.mesh_reach_m, body.mesh_placing_m);
  }
  static PartMotion triangle_of(const SweptBody& body, std::uint32_t number) {
    return {body.mesh->triangle(number), body.motion};
  }

  const SweptBody& a_;
  const SweptBody& b_;
  Vec3 origin_;
  const SweepOptions& options_;
  WalkCost& cost_;
  SweptContactOf contact_of_;
  std::uint32_t looks_ = 0;
  std::uint32_t filtered_ = 0;
  PieceOfBody piece_a_;
  PieceOfBody piece_b_;
};

/// Most pairs have the same frames as the previous pair.
const kernel::MotionPiece& SweptSearch::piece_of(PieceOfBody& kept, const BodyMotion& motion, const TimeSpan& span) {
  if (!kept.piece || kept.motion != &motion || kept.span.low != span.low || kept.span.high != span.high)
    kept = {kernel::MotionPiece(motion, span), &motion, span};
  return *kept.piece;
}

void SweptSearch::meet(const PartMotion& a, std::uint32_t a_triangle, const PartMotion& b, std::uint32_t b_triangle,
                       TimeSpan span) {
  SweptContact* touch = contact_of_(b_triangle);
  span = still_open(b_triangle, span);
  if (span.high < span.low || is_late()) return;
  ++touch->exact_tests;
  TimeBracket found;
  const ExactResult verdict = first_contact(a, b, span, options_.width, found, &looks_);
  touch->undecided = touch->undecided || verdict.decision == Decision::undecided;
  if (!verdict.yes()) return;
  if (!touch->take(found, a_triangle, b_triangle) || !options_.contacts) return;
  touch->contact = contact_at(a, b, found.high);
  touch->contact.point = back_from(origin_, touch->contact.point);
}

/// Tests the pieces of the motion in order of time. near(span, most, found) lists the pairs that may meet in a piece
/// and returns whether the list is complete; motion_m is how far the parts move in total.
///
/// before  number of pairs that may meet in the piece that this one was cut from
template <class Near>
void SweptSearch::look(const TimeSpan& span, std::size_t few, std::size_t before, double motion_m, double size_m,
                       const Near& near, const auto& meet_pair) {
  if (is_exhausted() || (is_one && is_settled(kNoTriangle, span))) return;
  std::vector<PartPair> found;
  const double length = span.high - span.low;
  const bool is_short = motion_m * length <= kShortPiece * size_m || length < kShortestPiece;
  // If the path is longer than the body, cutting separates the pairs.
  const std::size_t most = motion_m * length <= size_m ? kManyPairs * few : few;
  const bool is_all = near(span, is_short ? options_.most_looks : most, found);
  const bool is_few = is_all && (found.size() <= few || found.size() > before / 4 * 3);
  if (!is_few && !is_short) {
    const double middle = span.low + length / 2;
    const std::size_t here = is_all ? found.size() : kUnknownCount;
    look({span.low, middle}, few, here, motion_m, size_m, near, meet_pair);
    look({middle, span.high}, few, here, motion_m, size_m, near, meet_pair);
    return;
  }
  // Too many pairs even for the shortest piece: the search counts as exhausted.
  if (!is_all) looks_ = options_.most_looks;
  if (is_late()) return;
  // A split that clips triangles puts some into two leaves.
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  for (const PartPair& pair : found) {
    if (is_exhausted()) return;
    meet_pair(pair, span);
  }
}

/// Collects candidates up to a limit.
struct Listing {
  std::vector<PartPair>& found;
  std::size_t most;
  bool is_all = true;

  bool add(PartPair pair) {
    if (found.size() >= most) is_all = false;
    else found.push_back(pair);
    return is_all;
  }
};

/// How far the parts move relative to each other from the middle of a piece to its ends, along each axis, including the
/// rounding of both motions and placing_m.
Vec3 half_motion(const BodyMotion& a, double a_reach_m, const BodyMotion& b, double b_reach_m, double placing_m,
                 double length) {
  const double turn_m = a.turn_rad * a_reach_m + b.turn_rad * b_reach_m;
  const double error_m = 2 * (a.error_m(a_reach_m) + b.error_m(b_reach_m)) + placing_m;
  return ((a.travel - b.travel).cwiseAbs().array() + turn_m).matrix() * (length / 2 * (1 + kBoundSlack)) +
         Vec3::Constant(error_m);
}

double size_of(const Aabb& box) { return (box.high - box.low).maxCoeff(); }

/// True if the motions are so long that their rounding exceeds both bodies: parts cannot be distinguished.
bool are_blurred(const BodyMotion& a, double a_reach_m, const BodyMotion& b, double b_reach_m, double size_m) {
  return size_m > 0 && !(a.error_m(a_reach_m) + b.error_m(b_reach_m) <= size_m);
}

bool SweptSearch::is_apart(const PartMotion& primitive, const SweptBody& other, const Triangle& triangle,
                           const TimeSpan& span) {
  const std::optional<kernel::MovingCore> own = moving_core(primitive, piece_of(piece_a_, *primitive.motion, span));
  count_filtered();
  return own && kernel::surely_apart(*own, core_of(other, triangle, piece_of(piece_b_, other.motion, span)));
}

/// Visits triangles that may come within `motion` of the part. A ball's box holds far more of a surface that it nearly
/// touches than the ball does.
void SweptSearch::visit_near(const BoundedPart& part, const Vec3& motion, const SweptBody& other, const Frame& frame,
                             Bvh::BoxCandidate candidate) {
  if (const Sphere* ball = std::get_if<Sphere>(&part)) {
    const Vec3 away = ball->center - frame.position;
    const double slack_m = placement_slack(frame, away.lpNorm<1>() + ball->center.lpNorm<1>(), other.mesh_reach_m);
    const double limit_m2 = square_up(ball->radius_m + motion.norm() * (1 + kBoundSlack));
    const auto near = [&](std::uint32_t triangle, double limit) { return candidate(triangle) ? limit : -1; };
    other.tree->walk_near(frame.rotation.transpose() * away, limit_m2, slack_m, near, cost_);
    return;
  }
  Aabb box = std::visit([](const auto& shape) { return bounds(shape); }, part);
  box.low -= motion;
  box.high += motion;
  other.tree->walk_box(seen_from(frame, box, other.mesh_reach_m), candidate, cost_);
}

void SweptSearch::primitive_and_mesh(const PartMotion& primitive, const SweptBody& other, bool primitive_is_a) {
  const Aabb own = std::visit([](const auto& shape) { return bounds(shape); }, primitive.at(0));
  const double largest_m = std::max(size_of(own), size_of(other.tree->bounds()));
  if (are_blurred(*primitive.motion, primitive.reach_m, other.motion, other.mesh_reach_m, largest_m)) {
    looks_ = options_.most_looks;
    return;
  }
  const double motion_m = primitive.motion->length_m(primitive.reach_m) + other.motion.length_m(other.mesh_reach_m);
  const auto near = [&](const TimeSpan& span, std::size_t most, std::vector<PartPair>& found) {
    const double middle = span.low + (span.high - span.low) / 2;
    const BoundedPart part = primitive.at(middle);
    const Vec3 motion = half_motion(*primitive.motion, primitive.reach_m, other.motion, other.mesh_reach_m,
                                    primitive.placing_m + other.mesh_placing_m, span.high - span.low);
    Listing listing{found, most};
    const auto candidate = [&](std::uint32_t triangle) {
      return !is_late() && (is_settled(primitive_is_a ? triangle : kNoTriangle, span) || listing.add({0, triangle}));
    };
    visit_near(part, motion, other, other.motion.at(middle), candidate);
    return listing.is_all;
  };
  const auto meet_pair = [&](const PartPair& pair, const TimeSpan& span) {
    const TimeSpan open = still_open(primitive_is_a ? pair.b : kNoTriangle, span);
    if (open.high < open.low || is_apart(primitive, other, other.mesh->triangle(pair.b), open)) return;
    const PartMotion triangle = triangle_of(other, pair.b);
    if (primitive_is_a) meet(primitive, kNoTriangle, triangle, pair.b, span);
    else meet(triangle, pair.b, primitive, kNoTriangle, span);
  };
  look(options_.span, kPairsAPiece, kUnknownCount, motion_m, size_of(own), near, meet_pair);
}

void SweptSearch::meshes() {
  const double motion_m = a_.motion.length_m(a_.mesh_reach_m) + b_.motion.length_m(b_.mesh_reach_m);
  const auto [smaller_m, larger_m] = std::minmax({size_of(a_.tree->bounds()), size_of(b_.tree->bounds())});
  if (are_blurred(a_.motion, a_.mesh_reach_m, b_.motion, b_.mesh_reach_m, larger_m)) {
    looks_ = options_.most_looks;
    return;
  }
  const auto near = [&](const TimeSpan& span, std::size_t most, std::vector<PartPair>& found) {
    const double middle = span.low + (span.high - span.low) / 2;
    const Frame a = a_.motion.at(middle);
    const Frame b = b_.motion.at(middle);
    const Vec3 motion = half_motion(a_.motion, a_.mesh_reach_m, b_.motion, b_.mesh_reach_m,
                                    a_.mesh_placing_m + b_.mesh_placing_m, span.high - span.low);
    Listing listing{found, most};
    const auto candidate = [&](std::uint32_t triangle_b, std::uint32_t triangle_a) {
      return !is_late() && (is_settled(triangle_b, span) || listing.add({triangle_a, triangle_b}));
    };
    const Mat3 back = b.rotation.transpose();
    const Vec3 between = a.position - b.position;
    const double slack_m =
        2 * placement_slack(b, between.lpNorm<1>() + a.position.lpNorm<1>(), a_.mesh_reach_m + b_.mesh_reach_m) +
        motion.norm() * (1 + kBoundSlack);
    b_.tree->walk_pairs(*a_.tree, back * a.rotation, back * between, slack_m, candidate, cost_);
    return listing.is_all;
  };
  const auto meet_pair = [&](const PartPair& pair, const TimeSpan& span) {
    const TimeSpan open = still_open(pair.b, span);
    if (open.high < open.low) return;
    const kernel::MovingCore a = core_of(a_, a_.mesh->triangle(pair.a), piece_of(piece_a_, a_.motion, open));
    const kernel::MovingCore b = core_of(b_, b_.mesh->triangle(pair.b), piece_of(piece_b_, b_.motion, open));
    count_filtered();
    if (kernel::surely_apart(a, b)) return;
    meet(triangle_of(a_, pair.a), pair.a, triangle_of(b_, pair.b), pair.b, span);
  };
  look(options_.span, kMeshPairsAPiece, kUnknownCount, motion_m, smaller_m, near, meet_pair);
}

/// A half-space never moves, so it has a test of its own. A mesh that may come near one is undecided.
void SweptSearch::meet_ground(const SweptBody& body, const SweptBody& holder, const Primitive& ground,
                              bool ground_is_a) {
  SweptContact* touch = contact_of_(kNoTriangle);
  if (touch == nullptr) return;
  const HalfSpace placed = place(holder.motion.to, std::get<HalfSpace>(ground));
  GivenPart given;
  if (holder.motion.given != nullptr) given = {.own = &ground, .pose = holder.motion.given, .frame = &holder.motion.to};
  if (has_mesh(body) && !surely_stays_above(body.motion, body.mesh_reach_m, placed)) touch->undecided = true;
  for (const Primitive& own : body.primitives) {
    if (std::holds_alternative<HalfSpace>(own)) continue;
    if (is_late()) return;
    ++looks_;
    ++touch->exact_tests;
    const PartMotion part(part_of(own), body.motion);
    TimeBracket found;
    const ExactResult verdict =
        first_contact(part, placed, still_open(kNoTriangle, options_.span), options_.width, found, given);
    touch->undecided = touch->undecided || verdict.decision == Decision::undecided;
    if (!verdict.yes() || !touch->take(found, kNoTriangle, kNoTriangle) || !options_.contacts) continue;
    touch->contact = std::visit([&](const auto& shape) { return contact(placed, shape); }, part.at(found.high));
    touch->contact.point = back_from(origin_, touch->contact.point);
    if (!ground_is_a) touch->contact.normal = -touch->contact.normal;
  }
}

void SweptSearch::run() {
  const auto is_ground = [](const Primitive& primitive) { return std::holds_alternative<HalfSpace>(primitive); };
  for (const Primitive& own : a_.primitives) {
    if (is_ground(own)) {
      meet_ground(b_, a_, own, true);
      continue;
    }
    const PartMotion part(part_of(own), a_.motion);
    for (const Primitive& other : b_.primitives) {
      if (!is_ground(other)) meet(part, kNoTriangle, {part_of(other), b_.motion}, kNoTriangle, options_.span);
    }
    if (has_mesh(b_)) primitive_and_mesh(part, b_, true);
  }
  for (const Primitive& other : b_.primitives) {
    if (is_ground(other)) meet_ground(a_, b_, other, false);
    else if (has_mesh(a_)) primitive_and_mesh({part_of(other), b_.motion}, a_, false);
  }
  if (has_mesh(a_) && has_mesh(b_)) meshes();
}

}  // namespace

bool SweptContact::take(const TimeBracket& found, std::uint32_t a, std::uint32_t b) {
  const bool is_first = !yes || found.high < bracket.high ||
                        (found.high == bracket.high && std::pair(a, b) < std::pair(a_triangle, b_triangle));
  // A contact with a later end may begin earlier; the bracket covers all of them.
  const double low = yes ? std::min(bracket.low, found.low) : found.low;
  bracket = {low, is_first ? found.high : bracket.high};
  yes = true;
  if (!is_first) return false;
  a_triangle = a;
  b_triangle = b;
  return true;
}

SweptBody::SweptBody(const ObjectInfo& info, const BodyMotion& on) : motion(on), primitives(info.primitives) {
  if (!info.mesh) return;
  mesh = info.mesh->mesh.get();
  tree = &info.mesh->tree;
  mesh_reach_m = motion.lever_m(info.mesh->radius_m);
  mesh_placing_m = motion.placing_m(mesh_reach_m);
}

SweptBody::SweptBody(const StaticScene& scene) : mesh(&scene.mesh), tree(&scene.tree), is_scene(true) {}

namespace {

/// Bodies this many times farther from the world's origin than from each other are moved near the origin. Nearer than
/// that, a coordinate is rounded by less than a billionth of their distance.
constexpr double kFarFromEachOther = 0x1p20;

/// The corners of a box that contains all offsets added to the body's coordinates.
std::pair<Vec3, Vec3> places_of(const SweptBody& body) {
  if (body.is_scene) return {body.tree->bounds().low, body.tree->bounds().high};
  return {body.motion.from.position, body.motion.to.position};
}

}  // namespace

Vec3 common_origin(const SweptBody& a, const SweptBody& b) {
  const Vec3& point = b.is_scene ? a.motion.from.position : b.motion.from.position;
  const auto [first_a, last_a] = places_of(a);
  const auto [first_b, last_b] = places_of(b);
  double away_m = 0;
  for (const Vec3* other : {&first_a, &last_a, &first_b, &last_b}) away_m += (*other - point).lpNorm<1>();
  const double far_m = std::clamp(kFarFromEachOther * away_m, std::numeric_limits<double>::min(), kFarOut_m);
  return common_origin(point, {first_a, last_a, first_b, last_b}, far_m);
}

SeenBody::SeenBody(const Vec3& origin, const SweptBody& body) : body_(body) {
  body_.motion = seen_from(origin, body.motion);
  if (body.motion.given != nullptr) {
    given_ = seen_from(origin, *body.motion.given);
    body_.motion.given = &given_;
  }
  if (body.mesh != nullptr) body_.mesh_placing_m = body_.motion.placing_m(body.mesh_reach_m);
}

namespace {

/// Calls search(a, b, origin) with the two bodies as seen from a common origin.
template <class Search>
void search_near(const SweptBody& a, const SweptBody& b, Search&& search) {
  const Vec3 origin = common_origin(a, b);
  if (origin.isZero(0)) return search(a, b, origin);
  search(SeenBody(origin, a).body(), SeenBody(origin, b).body(), origin);
}

}  // namespace

void sweep(const SweptBody& a, const SweptBody& b, const SweepOptions& options, WalkCost& cost, SweptContact& touch) {
  search_near(a, b, [&](const SweptBody& near_a, const SweptBody& near_b, const Vec3& origin) {
    const auto one = [&](std::uint32_t) { return &touch; };
    SweptSearch search(near_a, near_b, origin, options, cost, one);
    search.is_one = true;
    search.run();
    search.count_looks();
    touch.is_cut_short = search.is_exhausted();
    touch.undecided = touch.undecided || touch.is_cut_short;
  });
}

bool sweep_scene(const SweptBody& a, const SweptBody& scene, const SweepOptions& options, WalkCost& cost,
                 SweptContactOf touch_of) {
  bool is_whole = false;
  search_near(a, scene, [&](const SweptBody& near_a, const SweptBody& near_scene, const Vec3& origin) {
    SweptSearch search(near_a, near_scene, origin, options, cost, touch_of);
    search.run();
    search.count_looks();
    is_whole = !search.is_exhausted();
  });
  return is_whole;
}

}  // namespace collided::engine
