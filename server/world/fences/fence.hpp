#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "collided/codes.hpp"
#include "server/exact_phase/given/given_gap.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// What a fence reports of an object, with the words of commands (kDetectEnter).
inline constexpr std::pair<const char*, std::uint8_t> kDetectWords[]{
    {"enter", codes::kDetectEnter}, {"exit", codes::kDetectExit}, {"cross", codes::kDetectCross}};
inline constexpr std::uint8_t kDetectAll = codes::kDetectEnter | codes::kDetectExit | codes::kDetectCross;

/// Distance bands about all objects of a name, as a definition of a fence has them: objects that come within a band are
/// reported. The bands descend; the last one is 0, contact.
struct MarginBands {
  std::string around = {};           // name glob of the objects that have the bands
  std::vector<double> bands_m = {};  // metres
  double hysteresis_m = 0;           // an object within a band leaves it beyond the band plus this
  std::int64_t dwell_ns = 0;         // it must be within, or beyond, for so long; but contact begins at once

  static constexpr std::size_t kMost = 8;  // bands
  static constexpr std::int64_t kLongestDwellNs = 3'600'000'000'000;
};

/// Why such bands are refused; empty: they are valid.
std::string refusal_of(const MarginBands& margin);

/// One band of a margin, which all objects that have it share.
struct BandRule {
  std::string margin = {};  // its name
  std::string around = {};  // name glob of the objects that have the bands; of fixed ones, of those that they look at
  double within_m = 0;
  double hysteresis_m = 0;
  std::int64_t dwell_in_ns = 0;
  std::int64_t dwell_out_ns = 0;

  GapLimit comes_in() const { return {within_m, 0}; }
  GapLimit stays_in() const { return {within_m, hysteresis_m}; }
  /// An object beyond this distance, in metres, cannot be in the band.
  double reach_m() const { return stays_in().high_m(); }
  bool operator==(const BandRule&) const = default;
};

/// A standing question: which object of a name is nearest to a point, or to the carrier of the fence definition that has
/// this rule.
struct NearestRule {
  double within_m = 0;      // what is farther away is not looked at
  double hysteresis_m = 0;  // another object takes the place of the nearest once it is nearer by more than this

  /// Beyond this distance, in metres, an object is no longer the nearest.
  double reach_m() const { return within_m + hysteresis_m; }
  bool operator==(const NearestRule&) const = default;
};

/// A region that stands in the world, or moves along with an object; objects that come in and go out are reported. It
/// touches nothing, and questions about the world ignore it.
struct FenceDefinition {
  std::string name = {};  // unique among fences
  /// Solid primitives, and a mesh only with what it encloses. Metres, in the world, or in the frame of its carrier.
  Shape shape = {};
  std::shared_ptr<const SolidMesh> solid = {};  // of the shape's mesh; null where it has none
  std::string carrier = {};                     // name of the object that it is fixed to; empty: the world
  std::string only = {};                        // name glob of the objects that it looks at; empty: all that move
  std::string skip = {};                        // name glob of those that it leaves out; empty: none
  std::uint32_t mask = 0xffffffff;              // an object's layers must have a bit of it
  std::uint8_t detects = kDetectAll;            // kDetect... bits
  std::uint64_t owner = 0;                      // for the caller that defines it; the world does not read it
  // A margin: instead of a shape that stands in the world, bands about objects; `only` names those that they look at.
  std::optional<MarginBands> margin = {};
  // A question for the nearest object: about its carrier, or where there is none about the centre of its shape, a sphere
  // of radius 0; `only` names the objects that it looks at, moving or not.
  std::optional<NearestRule> nearest = {};
};

/// What many fences have in common; equal rules are shared.
struct FenceRule {
  std::string carrier;
  std::string only;
  std::string skip;
  std::uint32_t mask = 0;
  std::uint8_t detects = 0;
  std::uint64_t owner = 0;
  std::optional<BandRule> band = {};        // it is a band of a margin, about its carrier
  std::optional<NearestRule> nearest = {};  // it is a question for the nearest object

  /// How long a change must have lasted before it is reported.
  std::int64_t dwell_ns(bool comes_in) const {
    if (!band) return 0;
    return comes_in ? band->dwell_in_ns : band->dwell_out_ns;
  }
  bool operator==(const FenceRule&) const = default;
};

}  // namespace collided::engine
