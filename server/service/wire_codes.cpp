// Numbers that go onto the wire as the engine has them; its codes are the wire's own (idl/generate.py).
#include "idl/fence_ids.hpp"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/events/events.hpp"
#include "server/world/objects/sources.hpp"
#include "server/world/query/probes.hpp"

namespace collided::engine::service {
namespace {

static_assert(wire_contract::kNearestBits == (kFenceBit | kNearestBit));
static_assert(wire_contract::kNearestGoesOn == kNearestGoesOn);
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
