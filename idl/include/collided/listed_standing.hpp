#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/geometry.hpp>

/// Standing questions as a server lists them. Metres, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

using codes::StandingForm;

/// A standing question (standing.hpp) in one flat form; members of other forms keep their defaults.
struct DefinedStanding {
  std::string name = {};
  StandingForm form = StandingForm::region;
  std::string only = {};  // as in Standing, and so are skip, mask and keep
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;
  bool keep = false;
  std::string kind = {};  // of a region: its shape (sphere, box, ..., mesh, compound)
  /// Of a region: the object that it moves along with. Of the nearest: the object that the distances are to. Empty: none,
  /// or `point`.
  std::string to = {};
  std::vector<std::string> detect = {};  // of a region: which of enter, exit and cross it reports
  std::string around = {};               // of bands: name glob of the objects that have the bands
  std::vector<double> bands_m = {};      // of bands: the widest first; the last one is 0, contact
  std::chrono::nanoseconds dwell{0};     // of bands: how long a change must last
  std::optional<Vec3> point = {};        // of the nearest, in place of `to`
  double within_m = 0;                   // of the nearest: objects farther away do not count
  double hysteresis_m = 0;               // of bands and the nearest
};

/// What a standing question holds: an object in the region, a pair within a band, or the object that is nearest.
struct HeldObject {
  std::string object = {};
  std::string other = {};             // of bands: the object that has the bands
  double band_m = 0;                  // of bands: the narrowest that the two are in
  bool in_doubt = false;              // whether it holds is not known
  std::chrono::nanoseconds since{0};  // world time by which it held
};

/// A standing question in the server, and what it holds.
struct ListedStanding : DefinedStanding {
  std::vector<HeldObject> holds = {};
  /// Of the nearest: searches cut short at the evaluation limit. A candidate that came and went during such an interval
  /// may be missing from the events.
  std::uint64_t cut_short = 0;
};

/// A region, or one band about one object, as pictures show it.
struct OutlinedStanding : DefinedStanding {
  std::uint64_t id = 0;    // another one of the same name has another number
  std::string about = {};  // of a band: the object that has it
  double band_m = 0;       // of a band
  std::vector<HeldObject> holds = {};
  /// Polylines of x, y, z after one another, in the frame of `to` or `about`; empty where they were not asked for.
  std::vector<std::vector<double>> lines = {};
};

}  // namespace collided

#pragma GCC visibility pop
