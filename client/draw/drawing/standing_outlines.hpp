#pragma once

#include <optional>
#include <string>
#include <vector>

#include "collided/client.hpp"
#include "idl/answers/standing.hpp"

namespace collided::draw {

/// The drawing of a standing question: a region, one band about one object, or the line to the nearest object from the
/// carrier or point of a question for the nearest.
struct StandingOutline : OutlinedStanding {
  std::optional<double> distance_m = {};  // of the nearest, along the line; nothing: unknown

  /// The object in whose frame the lines are; empty: they are in the world.
  const std::string& carrier() const;
  bool is_held() const { return !holds.empty(); }
  /// A half-space, of which the lines show a part.
  bool is_endless() const { return form == StandingForm::region && kind == "half_space"; }
};

constexpr auto fields_of(const StandingOutline*) {
  return listed(fields_of(static_cast<const OutlinedStanding*>(nullptr)), fields<&StandingOutline::distance_m>());
}

/// All regions and bands, at most a thousand. Asks the server once; waits at most a second.
///
/// with_lines  false: without them the answer is shorter
Result<std::vector<StandingOutline>> standing_outlines(Client& client, bool with_lines);

/// The questions for the nearest, each with a line in the world between both objects at their present poses; without a
/// line if no object is near enough. At most 50. Asks the server once, and once for each line.
Result<std::vector<StandingOutline>> nearest_outlines(Client& client);

/// The lines of an outline in the world.
///
/// carrier  where the object of carrier() is; the identity if the lines are in the world
std::vector<std::vector<Vec3>> placed_lines(const StandingOutline& outline, const Pose& carrier);

}  // namespace collided::draw
