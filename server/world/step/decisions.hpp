#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/function_ref.hpp"
#include "server/world/objects/contact_times.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/step/pair_ledger.hpp"
#include "server/world/step/pair_windows.hpp"
#include "server/world/step/piece_points.hpp"
#include "server/world/step/placed_boxes.hpp"
#include "server/world/step/separation_cache.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The first contact of a mover with one part of a static scene during its motion.
struct PartSweep {
  std::uint32_t part = 0;
  SweptContact touch;
};

/// A part of a static scene that contains some of the mover, or lies in it, though their surfaces do not touch; a is
/// the mover.
struct PartWithin {
  std::uint32_t part = 0;
  Contained contained = Contained::none;
};

/// For two objects whose surfaces do not touch: whether they are in contact all the same.
struct WithinSolid {
  bool is_some = false;                   // some of one lies within the other
  Contained contained = Contained::none;  // all of one lies within the other
};

/// Lists reused from step to step, so that deciding does not allocate.
struct DecisionLists {
  PartContacts part_touches{true};
  PartContacts touches_between{true};  // for one part, at a time between two poses
  std::vector<PartSweep> part_sweeps;
  std::vector<PartWithin> parts_within;
  PiecePoints pieces;
  PlacedBoxes boxes;
  std::vector<std::int64_t> cuts;
  ContactTimes times;                  // of the surfaces of the current pair, in the current piece
  std::vector<WithinSolid> gaps;       // after each of its intervals
  std::vector<std::uint32_t> unfound;  // numbers of open contacts
  std::vector<std::pair<std::uint32_t, std::uint32_t>> unfound_pairs;
};

/// Two objects in a piece of time in which both move straight and rotate evenly.
struct PairPiece {
  std::uint32_t a = 0;  // lower id
  std::uint32_t b = 0;
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  BodyMotion a_motion;
  BodyMotion b_motion;
  bool is_of_step = false;             // the motions by which both reached their present poses; else from the history
  bool is_timed = true;                // the publisher gives instants
  const StaticScene* scene = nullptr;  // one of the two is a part of this scene

  /// The piece with time reversed.
  PairPiece reversed() const {
    PairPiece back = *this;
    back.a_motion = a_motion.reversed();
    back.b_motion = b_motion.reversed();
    return back;
  }
};

/// The decisions of one step: sends each candidate's contact, at the end of the step and during it, to the ledger, or
/// to a block that is applied to the ledger later.
///
/// threads  one; with a block and lists for each, several may decide at once while the ledger is not written
class Decisions {
 public:
  /// lists  for one thread; their boxes are those of this step
  /// block  receives the findings of a helper thread; null: the ledger does
  Decisions(const StepView& step, ContactLedger& ledger, SeparationCache& apart, DecisionLists& lists, StepCost& cost,
            StepBlock* block = nullptr)
      : step_(step),
        rows_(step.rows),
        motion_(step.motion),
        ledger_(ledger, block),
        apart_(apart),
        lists_(lists),
        cost_(cost) {}

  /// Decides a mover against all parts of a scene.
  void decide_scene(std::uint32_t mover, std::size_t scene_number);
  /// Decides two objects, of which at least one moves and whose filters let them meet.
  void decide_pair(std::uint32_t first, std::uint32_t second);
  /// Prefetches what decide_pair() looks up first, and then the pair's contact if there is one. Only hints.
  [[gnu::always_inline]] void prefetch_pair(std::uint32_t first, std::uint32_t second) const {
    ledger_.all().prefetch(lower_id(first, second), higher_id(first, second));
  }
  [[gnu::always_inline]] void prefetch_contact(std::uint32_t first, std::uint32_t second) const {
    ledger_.all().prefetch_contact(lower_id(first, second), higher_id(first, second));
  }
  /// Decides each open contact that a cut-short search did not reach.
  void decide_open();
  /// Ends each contact that was not found again although one of its objects moved.
  void end_parted(std::int64_t last_step_ns);
  /// True if the two are known up to different times, or moved at different times; else they are decided at the step's
  /// end.
  bool are_on_common_time(std::uint32_t first, std::uint32_t second) const {
    return engine::are_on_common_time(step_, first, second);
  }
  /// Decides two such objects on all newly known time of both, in pieces that end at the poses of both: the result does
  /// not depend on the steps that deliver the time.
  void decide_on_common_time(std::uint32_t first, std::uint32_t second);
  /// True if two lone spheres certainly do not meet during their motions. Excludes most candidates from one compact
  /// array.
  bool stay_apart(std::uint32_t first, std::uint32_t second) const;
  /// True if one more pair may be tested and found.
  bool has_room() const;

  /// Candidates that a step may test per contact that it may find: pairs that are apart cost time but no memory.
  static constexpr std::uint64_t kCandidatesAContact = 16;
  /// True if after this many tests in a step's sweeps each sweep may still make as many as the first.
  static bool are_looks_free(std::uint64_t looks) { return looks + kMostSweepLooks <= kStepLooks; }

 private:
  /// Tests of pairs of parts that the sweep of one pair may make: about 20 ms, during which all other pairs wait.
  static constexpr std::uint32_t kMostSweepLooks = 10'000;
  /// Tests that all sweeps of a step may make before each one has only the least: about 0.1 s.
  static constexpr std::uint32_t kStepLooks = 50'000;
  static constexpr std::uint32_t kLeastSweepLooks = 200;

  // decisions.cpp: turns findings into calls of the ledger
  void report(ObjectId a, ObjectId b, const ContactSearch& touch, const SweptContact* sweep, std::uint32_t mover,
              Contained contained, const ContactEnd* parted = nullptr);
  void report_doubt(ObjectId a, ObjectId b, const ContactSearch& touch, const SweptContact* sweep, std::uint32_t mover);
  void set_bracket(FoundContact& found, const SweptContact* sweep, std::uint32_t mover) const;
  void set_bracket_of_moves(FoundContact& found) const;
  BodyMotion::PointVelocity velocity_at(const Vec3& point, std::uint32_t slot, double time, double slack_s) const;
  void decide_unfound();
  void decide_where_known(std::uint32_t first, std::uint32_t second);
  double seconds_ago(std::int64_t time_ns) const { return step_.seconds_ago(time_ns); }
  bool is_timed(std::uint32_t slot) const;

  // scene_decisions.cpp
  void touch_scene(const Placed& a, const StaticScene& scene, PartContacts& touches, std::uint32_t only = kNoScenePart);
  void touch_scene_with_mesh(const Placed& a, const StaticScene& scene, PartContacts& touches, std::uint32_t only);
  bool decide_part(std::uint32_t mover, const StaticScene& scene, const PartContact& found, const SweptContact* sweep,
                   const WithinSolid& within);
  ContactSearch touch_part(const PairPiece& piece, const Frame& frame, WithinSolid* within);
  SweptContact sweep_part_piece(const PairPiece& piece, const TimeSpan& span, double width);
  void sweep_through(std::uint32_t mover, const StaticScene& scene);
  void sweep_parts(std::uint32_t mover, const StaticScene& scene);
  void sweep_sphere_parts(const MovingSphere& path, const ObjectInfo& mover, const StaticScene& scene);
  bool is_sweepable(const ObjectInfo& mover, const StaticScene& scene, std::uint32_t part) const;
  SweptContact& part_sweep(std::uint32_t part);

  // within_decisions.cpp
  bool look_in(const Placed& outer, const Placed& inner, std::span<const Vec3> points, bool is_turned,
               ContactSearch& touch);
  Contained look_within(const Placed& a, const Placed& b, ContactSearch& touch);
  void look_within_scene(const Placed& a, const StaticScene& scene);
  Contained look_within_part_at(const Placed& a, const StaticScene& scene, std::uint32_t part, ContactSearch& touch);
  void look_within_part(const Placed& a, const StaticScene& scene, std::uint32_t part,
                        FunctionRef<Contained(ContactSearch& touch)> look);
  void set_change_of_containment(const PairPiece& piece, FoundContact& found);
  ContactEnd emerging(const PairPiece& piece);

  // pair_decisions.cpp
  WithinSolid search_placing(std::uint32_t first, std::uint32_t second, bool are_near, ContactSearch& touch);
  bool may_be_cut(std::uint32_t first, std::uint32_t second) const;
  std::optional<PairPiece> piece_of_step(std::uint32_t first, std::uint32_t second) const;
  bool boxes_stay_apart(std::uint32_t first, std::uint32_t second, const PlacedBoxPair& boxes) const;
  double placing_error_of(const FoundContact& found);
  std::optional<SweptContact> sweep_between(std::uint32_t first, std::uint32_t second, bool with_contact,
                                            std::uint32_t& mover);
  std::optional<SweptContact> sweep_sphere(std::uint32_t mover, std::uint32_t other, bool with_contact);
  SweptContact sweep_bodies(std::uint32_t first, std::uint32_t second, bool with_contact);
  SweepOptions sweep_options(std::uint32_t mover) const;
  std::uint32_t sweep_looks() const;

  // common_time.cpp: pairs of several publishers
  bool decide_piece(const PairPiece& piece);
  bool ways_stay_apart(std::uint32_t a, std::uint32_t b) const;
  bool balls_stay_apart(std::uint32_t a, std::uint32_t b, std::int64_t from_ns, std::int64_t to_ns) const;
  void begin_window(std::uint32_t first, std::uint32_t second, const PairWindow& window);
  bool decide_instant(std::uint32_t a, std::uint32_t b, std::int64_t time_ns, const ContactEnd& parted);
  ContactSearch touch_at_end(const PairPiece& piece, WithinSolid& within);
  ContactSearch touch_at(const PairPiece& piece, const Frame& frame_a, const Frame& frame_b, WithinSolid* within);
  SweptContact sweep_piece(const PairPiece& piece, bool with_contact = true);
  SweptContact sweep_span(const SweptBody& a, const SweptBody& b, const TimeSpan& span, double width,
                          bool with_contact = true);
  double bracket_width(const PairPiece& piece) const;
  std::optional<SweptContact> sweep_sphere_piece(const PairPiece& piece, bool a_is_sphere, bool with_contact);
  bool surely_stay_apart(const PairPiece& piece) const;
  void begin_in_motion(const PairPiece& piece, const ContactSearch& touch, const SweptContact& sweep,
                       Contained contained);
  ContactEnd parting(const PairPiece& piece);
  double placing_error_on(const PairPiece& piece, std::uint32_t a_triangle, std::uint32_t b_triangle) const;
  FoundContact found_at(const PairPiece& piece, std::uint32_t a_triangle, std::uint32_t b_triangle,
                        const Contact& contact, double time, std::optional<double> known_slack_s = {});
  struct PieceBracket {
    double low_s = 0;  // seconds before the step's world time
    double high_s = 0;
  };
  PieceBracket in_seconds(const PairPiece& piece, const TimeBracket& bracket, const Contact& at) const;
  PieceBracket in_seconds(const PairPiece& piece, const BracketNs& found) const;
  PieceBracket parted_in(const PairPiece& piece, const ContactInterval& interval) const;
  void doubt_after(const PairPiece& piece);
  void end_interval(const PairPiece& piece, std::size_t number);
  std::int64_t clock_error_ns(std::uint32_t a, std::uint32_t b) const;
  bool may_begin();
  void doubt_piece(const PairPiece& piece, const ContactSearch& touch, const SweptContact& sweep);

  // piece_intervals.cpp: pairs that may touch several times in a piece
  bool is_cut(const PairPiece& piece) const;
  bool decide_intervals(const PairPiece& piece, const ContactSearch& touch, const WithinSolid& within,
                        const SweptContact* first);
  bool find_intervals(const PairPiece& piece, const TouchAtEnd& begin, const TouchAtEnd& end,
                      const SweptContact* first);
  TouchAtEnd surfaces_at_begin(const PairPiece& piece);
  void report_intervals(const PairPiece& piece, const ContactSearch& touch);
  bool begin_interval(const PairPiece& piece, std::size_t number, const ContactSearch& touch);

  // kept_apart.cpp: pairs of meshes that need no test for some steps
  double gap_wanted_m(std::uint32_t slot) const;
  void look_for_gap(std::uint32_t first, std::uint32_t second);
  void look_for_gap(std::uint32_t mover, const StaticScene& scene, std::uint32_t partner);
  void remember_gap(std::uint32_t slot, std::uint32_t partner, double gap_m, bool there_is);

  ObjectId lower_id(std::uint32_t first, std::uint32_t second) const {
    return std::min(rows_.id(first), rows_.id(second));
  }
  ObjectId higher_id(std::uint32_t first, std::uint32_t second) const {
    return std::max(rows_.id(first), rows_.id(second));
  }
  bool is_bare_mesh(std::uint32_t slot) const { return engine::is_bare_mesh(*rows_.info(slot)); }
  Placed placed(std::uint32_t slot, bool with_bounds = true) const {
    return {.info = rows_.info(slot),
            .frame = rows_[slot].frame(),
            .bounds = with_bounds ? motion_.pose_bounds(slot) : Aabb{},
            .pose = &rows_[slot].pose};
  }
  /// True if each is one ball or one box: testing these needs no bounds, and takes no longer than computing bounds.
  bool are_balls_or_boxes(std::uint32_t first, std::uint32_t second) const {
    const auto is_one = [&](std::uint32_t slot) {
      return rows_[slot].is_lone_sphere() || lone_box(*rows_.info(slot)) != nullptr;
    };
    return is_one(first) && is_one(second);
  }
  /// A number for the scene where SeparationCache takes a slot; counts down from the highest.
  static std::uint32_t partner_of(std::size_t scene) { return kNoTriangle - static_cast<std::uint32_t>(scene); }

  const StepView& step_;
  const ObjectRows& rows_;
  const StepMotion& motion_;
  PairLedger ledger_;
  SeparationCache& apart_;
  DecisionLists& lists_;
  StepCost& cost_;
  WalkCost walk_;
};

}  // namespace collided::engine
