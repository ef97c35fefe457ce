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

/// Which changes a fence reports, with the words of commands (kDetectEnter).
inline constexpr std::pair<const char*, std::uint8_t> kDetectWords[]{
    {"enter", codes::kDetectEnter}, {"exit", codes::kDetectExit}, {"cross", codes::kDetectCross}};
inline constexpr std::uint8_t kDetectAll = codes::kDetectEnter | codes::kDetectExit | codes::kDetectCross;

/// Distance bands around all objects of a name, as part of a fence definition: objects that enter a band are reported.
/// The bands descend; the last one is 0, contact.
struct MarginBands {
  std::string around = {};           // name glob of the objects with the bands
  std::vector<double> bands_m = {};  // metres
  double hysteresis_m = 0;           // an object within a band leaves it beyond the band plus this
  std::int64_t dwell_ns = 0;         // an object must be inside, or outside, for this long; contact begins at once

  static constexpr std::size_t kMost = 8;  // most bands
  static constexpr std::int64_t kLongestDwellNs = 3'600'000'000'000;
};

/// The reason why such bands are refused; empty if they are valid.
std::string refusal_of(const MarginBands& margin);

/// One band of a margin, shared by all objects with the band.
struct BandRule {
  std::string margin = {};  // the margin's name
  std::string around = {};  // objects with the bands, by name glob; for static ones, the objects that they monitor
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

/// A standing question: which object of a name is nearest to a point, or to the carrier of the fence definition that
/// has this rule.
struct NearestRule {
  double within_m = 0;      // objects farther away are ignored
  double hysteresis_m = 0;  // another object replaces the nearest once it is nearer by more than this

  /// Beyond this distance, in metres, an object is no longer the nearest.
  double reach_m() const { return within_m + hysteresis_m; }
  bool operator==(const NearestRule&) const = default;
};

/// A region fixed in the world, or moving along with an object; objects that enter and leave are reported. It touches
/// nothing, and questions about the world ignore it.
struct FenceDefinition {
  std::string name = {};  // unique among fences
  /// Solid primitives, or a mesh with the solid that it encloses. Metres, in the world, or in the frame of its carrier.
  Shape shape = {};
  std::shared_ptr<const SolidMesh> solid = {};  // solid of the shape's mesh; null if there is none
  std::string carrier = {};                     // name of the object that it is fixed to; empty: the world
  std::string only = {};                        // name glob of the monitored objects; empty: all that move
  std::string skip = {};                        // name glob of objects to leave out; empty: none
  std::uint32_t mask = 0xffffffff;              // an object's layers must share a bit with it
  std::uint8_t detects = kDetectAll;            // kDetect... bits
  std::uint64_t owner = 0;                      // for the caller that defines it; not read by the world
  // A margin: instead of a shape in the world, bands around objects; `only` names the monitored objects.
  std::optional<MarginBands> margin = {};
  // A question for the nearest object to the carrier, or without one to the centre of the shape, a sphere of radius 0;
  // `only` names the monitored objects, moving or not.
  std::optional<NearestRule> nearest = {};
};

/// Properties that many fences share; equal rules are stored once.
struct FenceRule {
  std::string carrier;
  std::string only;
  std::string skip;
  std::uint32_t mask = 0;
  std::uint8_t detects = 0;
  std::uint64_t owner = 0;
  std::optional<BandRule> band = {};        // a band of a margin, around its carrier
  std::optional<NearestRule> nearest = {};  // a question for the nearest object

  /// How long a change must have lasted before it is reported.
  std::int64_t dwell_ns(bool comes_in) const {
    if (!band) return 0;
    return comes_in ? band->dwell_in_ns : band->dwell_out_ns;
  }
  bool operator==(const FenceRule&) const = default;
};

}  // namespace collided::engine
