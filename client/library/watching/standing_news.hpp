#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "collided/client.hpp"
#include "collided/standing.hpp"

namespace collided::client {

/// A change in the state of a standing question, in the form of a WatchStateOf: `a` is the object, `b` the question or
/// a band of it, and the pair has `began`, `ended` or is `open`. A user's event is one such change, or two with one
/// sequence number: a crossing is a silent `began` and an `ended`; for another nearest object, `began` follows a silent
/// `ended`.
struct StandingNews : Event {
  StandingEvent reported;      // the data of the event that is not in the other members
  std::uint8_t detects = 0;    // for a region: codes::kDetect... bits
  bool is_silent = false;      // the other part is the user's event; this one only if emitted as missed
  bool is_superseded = false;  // not reported, since the next nearest object's event has it as `other`
};

/// The user's event; nothing for silent news.
std::optional<StandingEvent> event_of(const StandingNews& news);

/// The key of a state that is valid in every life of a server: the object, the question, and for bands the other object
/// and the band.
using StandingNames = std::tuple<std::string, std::string, std::string, double>;
StandingNames names_of(const StandingNews& news);
/// The key shared by mutually exclusive states: a question has one nearest object.
StandingNames place_of(const StandingNews& news);
void take_names(const StandingNews& from, StandingNews& to);

/// True if the options request the event.
bool is_wanted(const StandingEvent& event, const StandingWatchOptions& options);

}  // namespace collided::client
