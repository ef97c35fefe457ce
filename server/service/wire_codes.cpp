// Codes go onto the wire as the engine has them, without a table; these assertions keep the engine's and the wire's
// numbers the same.
#include "idl/fence_ids.hpp"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/events/events.hpp"
#include "server/world/objects/sources.hpp"
#include "server/world/query/probes.hpp"

namespace collided::engine::service {
namespace {

template <class Own, class Wire>
constexpr bool same(Own own, Wire wire) {
  return static_cast<std::uint8_t>(own) == static_cast<std::uint8_t>(wire);
}

static_assert(wire_contract::kNearestBits == (kFenceBit | kNearestBit));
static_assert(wire_contract::kNearestGoesOn == kNearestGoesOn);
#define COLLIDED_SAME(Own, Wire, name) static_assert(same(Own::name, wire_contract::Wire::name))
COLLIDED_SAME(QuestionKind, RequestKind, ray);
COLLIDED_SAME(QuestionKind, RequestKind, sphere);
COLLIDED_SAME(QuestionKind, RequestKind, box);
COLLIDED_SAME(QuestionKind, RequestKind, near);
COLLIDED_SAME(QuestionKind, RequestKind, sweep);
COLLIDED_SAME(QuestionKind, RequestKind, inside);
COLLIDED_SAME(QuestionKind, RequestKind, what_if);
COLLIDED_SAME(HitMode, HitMode, closest);
COLLIDED_SAME(HitMode, HitMode, any);
COLLIDED_SAME(HitMode, HitMode, all);
COLLIDED_SAME(HitMode, HitMode, signed_near);
static_assert(static_cast<std::uint8_t>(wire_contract::HitMode::verdict) >
              static_cast<std::uint8_t>(HitMode::signed_near));
COLLIDED_SAME(Verdict, Verdict, miss);
COLLIDED_SAME(Verdict, Verdict, hit);
COLLIDED_SAME(Verdict, Verdict, undecided);
COLLIDED_SAME(Verdict, Verdict, invalid);
COLLIDED_SAME(UndecidedReason, UndecidedReason, none);
COLLIDED_SAME(UndecidedReason, UndecidedReason, numeric);
COLLIDED_SAME(UndecidedReason, UndecidedReason, stale_object);
COLLIDED_SAME(UndecidedReason, UndecidedReason, recovering);
COLLIDED_SAME(UndecidedReason, UndecidedReason, truncated);
COLLIDED_SAME(UndecidedReason, UndecidedReason, deadline);
COLLIDED_SAME(UndecidedReason, UndecidedReason, not_covered);
COLLIDED_SAME(EventKind, EventKind, began);
COLLIDED_SAME(EventKind, EventKind, persisted);
COLLIDED_SAME(EventKind, EventKind, ended);
COLLIDED_SAME(EventKind, EventKind, contained);
COLLIDED_SAME(EventKind, EventKind, emerged);
COLLIDED_SAME(EndReason, EndReason, none);
COLLIDED_SAME(EndReason, EndReason, separated);
COLLIDED_SAME(EndReason, EndReason, removed);
COLLIDED_SAME(EndReason, EndReason, publisher_lost);
COLLIDED_SAME(EndReason, EndReason, teleported);
COLLIDED_SAME(EndReason, EndReason, geometry_changed);
COLLIDED_SAME(EndReason, EndReason, server_stopping);
COLLIDED_SAME(EndReason, EndReason, server_restarted);
COLLIDED_SAME(EndReason, EndReason, crossed);
COLLIDED_SAME(EndReason, EndReason, fence_removed);
COLLIDED_SAME(EndReason, EndReason, decided);
COLLIDED_SAME(EndReason, EndReason, allowed);
COLLIDED_SAME(Doubt, Doubt, none);
COLLIDED_SAME(Doubt, Doubt, numeric);
COLLIDED_SAME(Doubt, Doubt, cost_limit);
COLLIDED_SAME(Doubt, Doubt, publisher_lost);
COLLIDED_SAME(LostPolicy, LostPolicy, remove);
COLLIDED_SAME(LostPolicy, LostPolicy, freeze);
COLLIDED_SAME(LostPolicy, LostPolicy, hold);
COLLIDED_SAME(ProbeState, ProbeState, absent);
COLLIDED_SAME(ProbeState, ProbeState, nothing);
COLLIDED_SAME(ProbeState, ProbeState, gap);
COLLIDED_SAME(ProbeState, ProbeState, touching);
COLLIDED_SAME(ProbeState, ProbeState, collision);
COLLIDED_SAME(ProbeState, ProbeState, deeper);
COLLIDED_SAME(ProbeState, ProbeState, undecided);
#undef COLLIDED_SAME
static_assert(kDefaultGapNs == wire_contract::kDefaultGapNs);
static_assert(kRayNumbers == wire_contract::kRayNumbers && kSphereNumbers == wire_contract::kSphereNumbers &&
              kBoxNumbers == wire_contract::kBoxNumbers && kNearNumbers == wire_contract::kNearNumbers &&
              kSweepNumbers == wire_contract::kSweepNumbers && kPoseNumbers == wire_contract::kPoseNumbers &&
              kInsideNumbers == wire_contract::kInsideNumbers);
static_assert(kInside == static_cast<int>(wire_contract::kInside) &&
              kStale == static_cast<int>(wire_contract::kStale) &&
              kByWinding == static_cast<int>(wire_contract::kByWinding));
static_assert(kUnitNormSlack == wire_contract::kUnitQuaternionSlack);
static_assert(kNoTriangle == wire_contract::kNoTriangle);

}  // namespace
}  // namespace collided::engine::service
