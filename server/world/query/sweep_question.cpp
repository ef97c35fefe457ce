// The first contact of a shape that a client moves from pose to pose, with everything at rest.

#include "server/world/objects/sweep.hpp"
#include "server/world/query/question.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/solid_hits.hpp"
#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

/// Resolves a micrometre of a motion of one metre.
constexpr double kAskedWidth = 1e-6;

/// A pose's seven numbers: position, then quaternion (w, x, y, z).
Pose pose_at(const double* n) { return {.position = point_of(n), .rotation = Quat(n[3], n[4], n[5], n[6])}; }

/// The earliest contact of all objects tested so far.
struct First {
  AnswerHit hit;
  bool any = false;
  TimeBracket bracket = {.low = 1, .high = 1};  // no contact up to `low` with any of them; `high` is that of the hit

  void take(ObjectId object, std::uint32_t triangle, const SweptContact& touch, std::uint8_t flags) {
    const TimeBracket& found = touch.bracket;
    bracket.low = std::min(bracket.low, found.low);
    const bool earlier = !any || found.high < bracket.high || (found.high == bracket.high && object < hit.object);
    if (!earlier) return;
    any = true;
    bracket.high = found.high;
    hit = {.object = object,
           .triangle = triangle,
           .flags = flags,
           .point = touch.contact.point,
           .normal = touch.contact.normal};
  }
};

SweepOptions options_of(Question& question) { return {.width = kAskedWidth, .deadline = &question.deadline}; }

/// Sweeps against everything in a scene that may answer: the first contact is the scene's.
void meet_scene(Question& question, const SweptBody& body, const StaticScene& scene, First& first) {
  SweptContact touch;
  const auto touch_of = [&](std::uint32_t triangle) {
    return question.allows_part(scene, scene.part_of(triangle)) ? &touch : nullptr;
  };
  const bool is_whole = sweep_scene(body, SweptBody(scene), options_of(question), question.walk, touch_of);
  question.exact_tests += touch.exact_tests;
  question.undecided = question.undecided || touch.undecided || !is_whole;
  if (!touch.yes) return;
  const std::uint32_t part = scene.part_of(touch.b_triangle);
  const ObjectId object = scene.part_objects[part];
  first.take(object, touch.b_triangle - scene.parts[part].first_triangle, touch, question.flags_of(object));
}

/// The moving shape at its start.
struct SweepStart {
  Pose pose;
  Placed placed;
  std::vector<Vec3> points;  // points of its pieces, computed on first use

  SweepStart(const ObjectInfo& mover, const double* n) : pose(pose_at(n)) {
    const Frame frame = frame_of(pose);
    placed = {.info = &mover, .frame = frame, .bounds = bounds_of(mover, frame), .pose = &pose};
  }
  SweepStart(const SweepStart&) = delete;
  SweepStart& operator=(const SweepStart&) = delete;
};

/// A shape that begins inside a solid has a contact at once, though it may meet its surface later or never.
void begin_in(Question& question, const SolidMesh& solid, const Placed& outer, SweepStart& start, First& first) {
  const bool is_met_at_start = first.any && first.bracket.high == 0;
  if (is_met_at_start || !overlaps(outer.bounds, start.placed.bounds) || question.deadline.is_over()) return;
  if (start.points.empty()) start.points = points_of_pieces(*start.placed.info);
  const PiecesWithin within =
      pieces_within(solid, outer, start.placed, start.points, question.deadline, question.walk, question.exact_tests);
  if (!within.some || question.deadline.was_over()) return;
  const ContactWithin found =
      contact_within(solid, outer, start.placed, within.point, question.walk, question.exact_tests);
  SweptContact touch;
  touch.yes = true;
  touch.bracket = {.low = 0, .high = 0};
  touch.contact = found.contact;
  const ObjectId object = outer.info->id;
  first.take(object, found.triangle, touch, static_cast<std::uint8_t>(question.flags_of(object) | kHitInside));
}

}  // namespace

void ask_sweep(Question& question, const double* n) {
  question.found.clear();
  const ObjectInfo& mover = *question.asked.mover;
  SweepStart start(mover, n);
  BodyMotion motion(start.placed.frame, frame_of(pose_at(n + kPoseNumbers)));
  motion.given = &start.pose;
  const SweptBody body(mover, motion);
  First first;
  const Aabb way = bounds(mover, body.motion, reach_of(mover));
  const SceneList& scenes = question.snapshot.scenes;
  scenes.walk_box(way, question.walk, [&](std::size_t index) {
    meet_scene(question, body, *scenes[index], first);
    visit_solid_parts(*scenes[index], start.placed.bounds, question, [&](const SolidPart& part, const Placed& outer) {
      begin_in(question, *part.solid, outer, start, first);
    });
    return true;
  });
  const auto candidate = [&](std::uint32_t slot) {
    const ObjectInfo& other = question.object(slot);
    if (!question.allows(other.id)) return true;
    SweptContact touch;
    const Placed placed = question.placed_without_bounds(slot);
    BodyMotion rest = BodyMotion::resting(placed.frame);
    rest.given = placed.pose;
    sweep(body, SweptBody(other, rest), options_of(question), question.walk, touch);
    question.exact_tests += touch.exact_tests;
    question.undecided = question.undecided || touch.undecided;
    if (touch.yes) first.take(other.id, touch.b_triangle, touch, question.flags_of(other.id));
    if (other.rare->solid) begin_in(question, *other.rare->solid, question.placed(slot), start, first);
    return !question.deadline.was_over();
  };
  if (question.snapshot.grid) question.snapshot.grid->walk_box(way, candidate, question.walk);
  if (!first.any) return;
  question.found.push_back(first.hit);
  question.bracket = {.low = std::min(first.bracket.low, first.bracket.high), .high = first.bracket.high};
}

}  // namespace collided::engine
