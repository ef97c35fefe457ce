#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::draw {

/// A fence, a band of a margin, or a question for the nearest (nearest_outlines.hpp), as pictures show it.
struct FenceOutline {
  std::string name;          // the fence's, or the margin's
  std::uint64_t number = 0;  // another one of the same name has another number
  bool is_band = false;
  double within_m = 0;    // of a band
  bool is_plane = false;  // a half-space, of which the lines show a part
  std::string to = {};    // the object that carries it; empty: it stands in the world
  std::vector<std::string> inside = {};
  std::vector<std::string> in_doubt = {};
  std::vector<std::vector<Vec3>> lines = {};  // in its frame; empty where they were not asked for
  bool is_nearest = false;                    // a question, and `inside` is the one object that is nearest
  std::string of = {};                        // of a question: the object that it is about; empty: a point
  std::optional<double> distance_m = {};      // of the two; nothing: not known
  /// What was asked for when it was added, by the names of the server's list: only, skip, mask, keep, and of each kind more.
  std::map<std::string, std::string> definition = {};

  bool is_entered() const { return !inside.empty() || !in_doubt.empty(); }
};

/// All fences and bands, at most a thousand. Asks the server once; waits at most a second.
///
/// with_lines  else the answer is shorter
Result<std::vector<FenceOutline>> fence_outlines(Client& client, bool with_lines);

/// The lines of an outline in the world: those of one that is carried at its carrier's pose.
std::vector<std::vector<Vec3>> placed_lines(const FenceOutline& outline, const Pose& carrier);

}  // namespace collided::draw
