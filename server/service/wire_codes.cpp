// Numbers of the engine that are also on the wire; its codes are the wire's own (idl/generate.py).
#include "idl/fence_ids.hpp"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/events/events.hpp"
#include "server/world/objects/sources.hpp"

namespace collided::engine::service {
namespace {

static_assert(wire_contract::kNearestBits == (kFenceBit | kNearestBit));
static_assert(wire_contract::kNearestGoesOn == kNearestGoesOn);
static_assert(kDefaultGapNs == wire_contract::kDefaultGapNs);
static_assert(kUnitNormSlack == wire_contract::kUnitQuaternionSlack);
static_assert(kNoTriangle == wire_contract::kNoTriangle);

}  // namespace
}  // namespace collided::engine::service
