#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/geometry.hpp>

/// Standing questions as listed by a server. Metres, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

using codes::StandingForm;

/// A standing question (standing.hpp) as one flat struct; members of other forms keep their defaults.
struct DefinedStanding {
  std::string name = {};
  StandingForm form = StandingForm::region;
  std::string only = {};  // as in Standing, and so are skip, mask and keep
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;
  bool keep = false;
  std::string kind = {};  // for a region: its shape (sphere, box, ..., mesh, compound)
  /// For a region: the object it moves along with. For the nearest: the object that the distances are to. Empty: none,
  /// or `point`.
  std::string to = {};
  std::vector<std::string> detect = {};  // for a region: which of enter, exit and cross it reports
  std::string around = {};               // for bands: name glob of the objects that have the bands
  std::vector<double> bands_m = {};      // for bands: the widest first; the last one is 0, contact
  std::chrono::nanoseconds dwell{0};     // for bands: how long a change must last
  std::optional<Vec3> point = {};        // for the nearest, instead of `to`
  double within_m = 0;                   // for the nearest: objects farther away do not count
  double hysteresis_m = 0;               // for bands and the nearest
};

/// An element of a standing question's answer: an object in the region, a pair within a band, or the nearest object.
struct HeldObject {
  std::string object = {};
  std::string other = {};             // for bands: the object that has the bands
  double band_m = 0;                  // for bands: the narrowest that the two are in
  bool in_doubt = false;              // it is not known whether it holds
  std::chrono::nanoseconds since{0};  // world time by which it held
};

/// A standing question in the server, with its current answer.
struct ListedStanding : DefinedStanding {
  std::vector<HeldObject> holds = {};
  /// For the nearest: searches cut short at the evaluation limit. A candidate that came and went during such an
  /// interval may be missing from the events.
  std::uint64_t cut_short = 0;
};

/// A region, or one band about one object, for drawing.
struct OutlinedStanding : DefinedStanding {
  std::uint64_t id = 0;    // unique; a later one of the same name has another number
  std::string about = {};  // for a band: the object that has it
  double band_m = 0;       // for a band
  std::vector<HeldObject> holds = {};
  /// Polylines, each a list of x, y, z, in the frame of `to` or `about`; empty unless requested.
  std::vector<std::vector<double>> lines = {};
};

}  // namespace collided

#pragma GCC visibility pop
