#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/cli/session.hpp"

namespace collided::cli {

/// A recording to ask instead of a running server's world.
struct RecordedWorld {
  std::string path;
  std::vector<std::string>
      scenes;         // files of the scenes that its server had loaded; none: the small warehouse, if it had that
  std::string as_of;  // as in --as-of, for the recording; empty: its end
};

/// Asks the server of that session for an explanation; throws Failure.
using AskExplanation = std::function<nlohmann::json(Session&, const Globals&, nlohmann::json arguments)>;

/// Explains a ray or a pair: replays a recording up to the instant into a server of this program's own, and asks that.
/// The answer's times are the recording's; its version is 0. Throws Failure.
///
/// arguments  of the command explain, without the instant
/// lead       time of the replay, so that moving objects have a path
nlohmann::json explain_recorded(Session& session, const Globals& globals, const RecordedWorld& world,
                                nlohmann::json arguments, std::chrono::nanoseconds lead, const AskExplanation& ask);

/// Explains a region or a question for the nearest in the same way, by the newest poses known at the instant.
///
/// arguments  of the command explain, with `standing`
nlohmann::json explain_recorded_standing(Session& session, const Globals& globals, const RecordedWorld& world,
                                         nlohmann::json arguments, const AskExplanation& ask);

/// Explains an event of contacts in the same way.
///
/// sequence  that the event had when it was recorded
nlohmann::json explain_recorded_event(Session& session, const Globals& globals, const RecordedWorld& world,
                                      std::uint64_t sequence, const AskExplanation& ask);

}  // namespace collided::cli
