#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "collided/codes.hpp"
#include "server/world/fences/margin.hpp"
#include "server/world/fences/nearest.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// What a fence reports of an object, with the words of commands (kTellsEnter).
inline constexpr std::pair<const char*, std::uint8_t> kTellsWords[]{
    {"enter", codes::kTellsEnter}, {"exit", codes::kTellsExit}, {"cross", codes::kTellsCross}};
inline constexpr std::uint8_t kTellsAll = codes::kTellsEnter | codes::kTellsExit | codes::kTellsCross;

/// A region that stands in the world, or moves along with an object, and of which it is told which objects are in it.
/// It touches nothing and no question meets it.
struct FenceDefinition {
  std::string name = {};  // unique among fences
  /// Solid primitives, and a mesh only with what it encloses. Metres, in the world, or in the frame of its carrier.
  Shape shape = {};
  std::shared_ptr<const SolidMesh> solid = {};  // of the shape's mesh; null where it has none
  std::string carrier = {};                     // name of the object that it is fixed to; empty: the world
  std::string only = {};                        // name glob of the objects that it looks at; empty: all that move
  std::string skip = {};                        // name glob of those that it leaves out; empty: none
  std::uint32_t mask = 0xffffffff;              // an object's layers must have a bit of it
  std::uint8_t tells = kTellsAll;               // kTells... bits
  std::uint64_t owner = 0;                      // for whoever defines it; the world does not read it
  // A margin: instead of a shape that stands in the world, bands about objects; `only` is whom they look at.
  std::optional<MarginBands> margin = {};
  // A question for the nearest object: about its carrier, or where there is none about the centre of its shape, a sphere
  // of radius 0; `only` is whom it looks at, whether they move or not.
  std::optional<NearestRule> nearest = {};
};

/// What many fences have in common; equal rules are shared.
struct FenceRule {
  std::string carrier;
  std::string only;
  std::string skip;
  std::uint32_t mask = 0;
  std::uint8_t tells = 0;
  std::uint64_t owner = 0;
  std::optional<BandRule> band = {};        // it is a band of a margin, about its carrier
  std::optional<NearestRule> nearest = {};  // it is a question for the nearest object

  bool operator==(const FenceRule&) const = default;
};

}  // namespace collided::engine
