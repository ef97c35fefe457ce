#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/draw/drawing/picture.hpp"
#include "client/draw/drawing/sight.hpp"

namespace collided::draw {

/// Objects that are coloured by their distance to everything that is not named like them.
struct ClearanceRamp {
  std::vector<std::uint8_t> is_measured;  // of each shown object
  std::string name_glob;                  // theirs
  double reach_m = 1;                     // beyond it the last band
  int bands = 8;
};

struct ToneOptions {
  int tones = 2;
  Vec3 toward_light = Vec3::UnitZ();  // of unit length, in the world
  double crease_cosine = 0.5;
  std::optional<ClearanceRamp> clearance{};
};

/// What each pixel's middle sees.
struct ToneMap {
  static constexpr float kNothing = -1;
  int width = 0;
  int height = 0;
  std::vector<float> light;           // n . l of the normal turned to the eye, at least 0; kNothing: nothing is seen
  std::vector<std::uint8_t> numbers;  // tone, then clearance bands behind the tones; Pixels::kPaperPixel: nothing
};

/// The tone of n . l: 0 in [0, 1/k), where it is negative too, up to k - 1.
int tone_of(double light, int tones);

/// Rays through every fourth pixel, and through those between wherever four neighbours differ or a line runs: so tones
/// change where n . l crosses a threshold, to the pixel, as long as what is round is larger than some pixels.
/// lines  of the picture: their pixels are all looked through
ToneMap cast_tones(const ShownObjects& shown, const Camera& camera, std::span<const Segment> lines,
                   const ToneOptions& options, Rays& rays);

/// One hatching line after the other, broken where it is too light for it: 16 lines from light to dark, the second 8
/// across the first, each drawn wherever the tone is darker than its own threshold. So there is never less ink where it
/// is darker. source  Praun, Hoppe, Webb, Finkelstein, "Real-Time Hatching", 2001 (tonal art maps: what light tones
/// have, dark ones keep)
std::vector<std::vector<Spot>> hatching(const ToneMap& map, double spacing_px);

}  // namespace collided::draw
