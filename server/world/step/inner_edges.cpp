#include "server/world/step/inner_edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/distance/convex.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {
namespace {

using kernel::Convex;

constexpr std::size_t kMostPrimitives = 16;
constexpr std::size_t kMostContacts = 64;
constexpr std::size_t kAhead = 16;  // movers whose contacts are prefetched together
/// For unit normals: closer than this they are the same; up to this beyond a right angle they do not oppose each other.
constexpr double kSameNormal = 1e-12;
/// Covers the roundings of two reaches in double and in Bounded, and of placing both boxes (at most 52 of their
/// coordinates, kPlacementRoundoffs), relative to their coordinates and sizes: 2^13 of them. No unit.
/// At zero, ExtremeInnerEdge.SoTheyDoOnATurnedFloorFarOut fails.
constexpr double kQuickReach = 0x1p-40;

bool has_faces(const Primitive& primitive) {
  return std::holds_alternative<Box>(primitive) || std::holds_alternative<Hull>(primitive) ||
         std::holds_alternative<HalfSpace>(primitive);
}

/// A contact seen from one of its two bodies, the mover.
struct MoverContact {
  ObjectId mover = 0;
  std::size_t number = 0;  // index of the open contact
  ObjectId body = 0;       // the other object
  std::uint32_t triangle = kNoTriangle;
  Vec3 normal = Vec3::Zero();        // from the mover to the body
  mutable std::optional<Box> box{};  // the body as placed, once it was needed
  // another contact's normal separates the mover from this body too
  bool is_covered = false;
};

struct Corrected {
  ObjectId mover = 0;
  std::size_t number = 0;  // of the open contact
  Contact surface;
};

class Correction {
 public:
  Correction(const ObjectRows& rows, const StepMotion& motion, const SceneList& scenes, ContactLedger& ledger)
      : rows_(rows), motion_(motion), scenes_(scenes), ledger_(ledger) {}

  void run() {
    corrected_.clear();
    movers_.clear();
    for (const std::uint32_t slot : ledger_.found_slots()) {
      const std::uint32_t side_count = ledger_.face_count(slot);
      if (side_count < 2 || side_count > kMostContacts || rows_.source(slot) == Sources::kResting) continue;
      movers_.push_back(slot);
    }
    for (std::size_t first = 0; first < movers_.size(); first += kAhead) {
      const auto some = std::span(movers_).subspan(first, std::min(kAhead, movers_.size() - first));
      prefetch(some);
      for (const std::uint32_t slot : some) {
        collect(slot);
        look_at();
      }
    }
    // If both objects of a contact are movers, the one with the higher id decides.
    std::sort(corrected_.begin(), corrected_.end(), [](const Corrected& x, const Corrected& y) {
      return x.mover != y.mover ? x.mover < y.mover : x.number < y.number;
    });
    for (const Corrected& corrected : corrected_) ledger_.correct(corrected.number, corrected.surface);
    if (!corrected_.empty()) ledger_.retell_corrected();
  }

 private:
  const ObjectInfo& info(ObjectId id) const { return *rows_.info(slot_of(id)); }

  /// Prefetches what collect() reads for some movers: neighbours in space are far apart in memory.
  void prefetch(std::span<const std::uint32_t> movers) {
    ahead_.clear();
    for (const std::uint32_t slot : movers) {
      ledger_.for_each_at_faces(slot, [&](std::uint32_t number) {
        ahead_.push_back(number);
        return true;
      });
    }
    for (const std::uint32_t number : ahead_) ledger_.prefetch_contact(number);
  }

  /// The mover's contacts with bodies that have faces, found in this step or before, by body. Doubts are left out
  /// because they have no normal, contained objects because they touch no face.
  void collect(std::uint32_t slot) {
    sides_.clear();
    ledger_.for_each_at_faces(slot, [&](std::uint32_t number) {
      const OpenContact& open = ledger_.open()[number];
      const bool is_first = slot_of(open.a) == slot;
      sides_.push_back({.mover = is_first ? open.a : open.b,
                        .number = number,
                        .body = is_first ? open.b : open.a,
                        .triangle = is_first ? open.b_triangle : open.a_triangle,
                        .normal = is_first ? open.contact.normal : Vec3(-open.contact.normal),
                        .is_covered = false});
      return true;
    });
    std::sort(sides_.begin(), sides_.end(),
              [](const MoverContact& x, const MoverContact& y) { return x.body < y.body; });
  }

  void look_at() {
    // A contact at rest matters only if one found in this step is covered, which is rare.
    bool is_any_covered = false;
    for (MoverContact& side : sides_) {
      if (ledger_.found(side.number)) is_any_covered |= side.is_covered = is_covered(side);
    }
    if (!is_any_covered) return;
    for (MoverContact& side : sides_) {
      if (!ledger_.found(side.number)) side.is_covered = is_covered(side);
    }
    for (const MoverContact& side : sides_) {
      if (!side.is_covered || !ledger_.found(side.number)) continue;
      if (const MoverContact* face = face_for(side)) take_normal(side, *face);
    }
  }

  bool is_covered(const MoverContact& side) const {
    return std::any_of(sides_.begin(), sides_.end(), [&](const MoverContact& other) {
      return &other != &side && !is_same(other, side) && covers(other, side);
    });
  }

  /// The uncovered contact with the closest normal that covers this one; null if an uncovered one has the same normal.
  const MoverContact* face_for(const MoverContact& side) const {
    const MoverContact* best = nullptr;
    for (const MoverContact& other : sides_) {
      if (other.is_covered) continue;
      if (is_same(other, side)) return nullptr;
      const bool nearer = best == nullptr || other.normal.dot(side.normal) > best->normal.dot(side.normal);
      if (nearer && covers(other, side)) best = &other;
    }
    return best;
  }

  static bool is_same(const MoverContact& a, const MoverContact& b) {
    return a.normal.dot(b.normal) >= 1 - kSameNormal;
  }

  /// True if the other body comes no nearer to the mover along the first contact's normal.
  bool covers(const MoverContact& one, const MoverContact& other) const {
    if (one.normal.dot(other.normal) < -kSameNormal) return false;
    const Vec3 towards = -one.normal;
    const Vec3& origin = ledger_.open()[one.number].contact.point;
    const Decision quick = quickly_reaches_no_farther(one, other, towards, origin);
    if (quick != Decision::undecided) return quick == Decision::yes;
    const Bounded reach = reach_of(one, towards, origin);
    const Bounded others = reach_of(other, towards, origin);
    return std::isfinite(reach.high()) &&
           others.high() <= reach.high() + rounding_m(one.body) + rounding_m(other.body) && std::isfinite(others.low());
  }

  /// The comparison of covers() for two boxes in plain double, if that decides it.
  Decision quickly_reaches_no_farther(const MoverContact& one, const MoverContact& other, const Vec3& along,
                                      const Vec3& origin) const {
    const Box* box = placed_box(one);
    const Box* other_box = placed_box(other);
    if (box == nullptr || other_box == nullptr) return Decision::undecided;
    double scale_m = 0;
    const auto reach_m = [&](const Box& placed) {
      const Vec3 to_center = placed.center - origin;
      double reach = along.dot(to_center);
      for (int i = 0; i < 3; ++i) reach += placed.half_m[i] * std::abs(along.dot(placed.axes.col(i)));
      scale_m += placed.center.cwiseAbs().sum() + to_center.cwiseAbs().sum() + 2 * placed.half_m.sum();
      return reach;
    };
    const double farther_m = reach_m(*other_box) - reach_m(*box);
    const double error_m = kQuickReach * scale_m;
    if (farther_m > error_m) return Decision::no;
    return farther_m < -error_m ? Decision::yes : Decision::undecided;
  }

  /// The body's box as placed; null for any other body. Computed on demand: most normals oppose each other.
  const Box* placed_box(const MoverContact& side) const {
    if (side.box) return &*side.box;
    const Box* own = lone_box(info(side.body));
    if (own == nullptr) return nullptr;
    side.box = place(rows_[slot_of(side.body)].frame(), *own);
    return &*side.box;
  }

  double rounding_m(ObjectId id) const {
    const ObjectInfo& own = info(id);
    if (own.scene_part != kNoScenePart) return 0;
    const Aabb bounds = motion_.pose_bounds(slot_of(id));
    const Vec3 size = bounds.high - bounds.low;
    const double slack_m = placement_slack(rows_[slot_of(id)].pose.position, 0, size.lpNorm<1>());
    return std::isfinite(slack_m) ? slack_m : 0;
  }

  /// How far the touched part of the side's body reaches along a direction, from the origin.
  Bounded reach_of(const MoverContact& side, const Vec3& along, const Vec3& origin) const {
    if (const std::optional<Triangle> triangle = touched_triangle(side)) {
      return kernel::reach_value(Convex(*triangle), along, +1, origin);
    }
    std::optional<Bounded> most;
    for (const Primitive& own : info(side.body).primitives) {
      const Primitive placed = place(rows_[slot_of(side.body)].frame(), own);
      const Bounded reach = std::visit([&](const auto& shape) { return reach_of(shape, along, origin); }, placed);
      most = most ? max(*most, reach) : reach;
    }
    return most.value_or(Bounded(std::numeric_limits<double>::infinity()));
  }
  template <class Shape>
  static Bounded reach_of(const Shape& shape, const Vec3& along, const Vec3& origin) {
    return kernel::reach_value(Convex(shape), along, +1, origin);
  }
  /// A half-space is infinite in every direction but its own normal.
  static Bounded reach_of(const HalfSpace& half_space, const Vec3& along, const Vec3& origin) {
    if (kernel::unit(half_space.normal) != along) return Bounded(std::numeric_limits<double>::infinity());
    return kernel::reach_value(Convex(Sphere{half_space.point, 0}), along, +1, origin);
  }

  std::optional<Triangle> touched_triangle(const MoverContact& side) const {
    if (side.triangle == kNoTriangle) return std::nullopt;
    const ObjectInfo& own = info(side.body);
    if (own.mesh) return place(rows_[slot_of(side.body)].frame(), own.mesh->mesh->triangle(side.triangle));
    for (const auto& scene : scenes_) {
      if (own.scene_part >= scene->parts.size() || scene->part_objects[own.scene_part] != side.body) continue;
      return scene->mesh.triangle(scene->parts[own.scene_part].first_triangle + side.triangle);
    }
    return std::nullopt;
  }

  void take_normal(const MoverContact& side, const MoverContact& from) {
    const OpenContact& open = ledger_.open()[side.number];
    const Contact& face = ledger_.open()[from.number].contact;
    const Vec3 towards = -from.normal;
    // The mover's extent along the normal is the same in both contacts, so the depths differ by the bodies' extents.
    const Bounded depth = Bounded(face.depth_m, face.depth_error_m) +
                          (reach_of(side, towards, face.point) - reach_of(from, towards, face.point));
    Contact surface = open.contact;
    surface.normal = side.mover == open.a ? from.normal : Vec3(-from.normal);
    surface.depth_m = std::max(depth.value, 0.0);
    surface.depth_error_m = depth.bound() + (surface.depth_m - depth.value);
    corrected_.push_back({side.mover, side.number, surface});
  }

  const ObjectRows& rows_;
  const StepMotion& motion_;
  const SceneList& scenes_;
  ContactLedger& ledger_;
  // Reused from step to step.
  static thread_local std::vector<std::uint32_t> movers_;
  static thread_local std::vector<std::uint32_t> ahead_;
  static thread_local std::vector<MoverContact> sides_;
  static thread_local std::vector<Corrected> corrected_;
};

thread_local std::vector<std::uint32_t> Correction::movers_;
thread_local std::vector<std::uint32_t> Correction::ahead_;
thread_local std::vector<MoverContact> Correction::sides_;
thread_local std::vector<Corrected> Correction::corrected_;

}  // namespace

bool has_flat_faces(const ObjectInfo& info) {
  if (info.scene_part != kNoScenePart || info.mesh) return true;
  return info.primitives.size() <= kMostPrimitives &&
         std::any_of(info.primitives.begin(), info.primitives.end(), [](const Primitive& p) { return has_faces(p); });
}

void correct_inner_edges(const ObjectRows& rows, const StepMotion& motion, const SceneList& scenes,
                         ContactLedger& ledger) {
  Correction(rows, motion, scenes, ledger).run();
}

}  // namespace collided::engine
