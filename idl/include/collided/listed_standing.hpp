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
  std::string only = {};  // as in Standing, and so are the next three
  std::string skip = {};
  std::uint32_t mask = 0xffffffff;
  bool keep = false;
  // Of a region: what its shape is (sphere, box, ..., mesh, compound), the object that it moves along with, and which of
  // enter, exit and cross it reports.
  std::string kind = {};
  std::string to = {};  // of the nearest: the object that the distances are to; empty: `point`
  std::vector<std::string> detect = {};
  // Of bands.
  std::string around = {};
  std::vector<double> bands_m = {};  // the widest first; the last one is 0, contact
  std::chrono::nanoseconds dwell{0};
  // Of the nearest.
  std::optional<Vec3> point = {};
  double within_m = 0;
  double hysteresis_m = 0;  // of bands too
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
  /// Of the nearest: searches that ended at their limit of looks, so far. An object that became the nearest and was it no
  /// longer within such a piece of the way may not be reported.
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
