#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "collided/client.hpp"
#include "collided/standing.hpp"

namespace collided::client {

/// A change of what holds of a standing question, as a WatchStateOf takes it: `a` is the object, `b` the question or the band
/// of one, and the two are `began`, `ended` or `open`. An event that a user gets is one such change or two with one sequence
/// number: a crossing is a silent `began` and an `ended`; of another nearest object the `began` follows a silent `ended`.
struct StandingNews : Event {
  StandingEvent reported;      // what event_of() does not find in the other members
  std::uint8_t detects = 0;    // of a region: codes::kDetect... bits
  bool is_silent = false;      // the other part is what a user gets; this one only where it was missed
  bool is_superseded = false;  // a user does not get it, since the next nearest object's event has it as `other`
};

/// What a user gets of it; nothing for silent news.
std::optional<StandingEvent> event_of(const StandingNews& news);

/// By which what holds is known in every life of a server: the object, the question, and of bands the other object and the band.
using StandingNames = std::tuple<std::string, std::string, std::string, double>;
StandingNames names_of(const StandingNews& news);
/// The same of all that cannot hold at a time: a question has one nearest object.
StandingNames place_of(const StandingNews& news);
void take_names(const StandingNews& from, StandingNews& to);

/// Whether an event is one that the options ask for.
bool is_wanted(const StandingEvent& event, const StandingWatchOptions& options);

}  // namespace collided::client
