#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "idl/clocks.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/step/step_motion.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// Data that a step reads while it decides; nothing changes it meanwhile.
struct StepView {
  const ObjectRows& rows;
  const StepMotion& motion;
  const Sources& sources;
  const SceneList& scenes;
  const WorldOptions& options;
  StepOptions step_options;
  std::int64_t world_time_ns;
  bool looks_at_all;  // test pairs at rest as well, because the last search was cut short

  double seconds_ago(std::int64_t time_ns) const {
    return static_cast<double>(world_time_ns - time_ns) * wire_contract::kNanosecond_s;
  }
};

}  // namespace collided::engine
