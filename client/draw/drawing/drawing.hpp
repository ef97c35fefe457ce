#pragma once

#include <optional>
#include <vector>

#include "client/draw/drawing/halo.hpp"
#include "client/draw/drawing/picture.hpp"
#include "client/draw/drawing/tones.hpp"

namespace collided::draw {

enum class Style { wireframe, hidden_line, obscured_line, haloed, toon, hatched };

/// Where two objects bear on each other.
struct ContactMark {
  Vec3 point;
  Vec3 normal;
  double depth_m = 0;
};

/// A ray that was asked, to where it met something or to where it leaves the picture.
struct RayMark {
  Vec3 origin;
  Vec3 end;
  bool is_hit = false;
};

struct DrawOptions {
  View view{};
  Style style = Style::hidden_line;
  int tones = 3;                       // of the toon style
  std::optional<Vec3> toward_light{};  // in the world, any length; none: from above, left of the eye
  double crease_cosine = 0.866;        // as the shapes were asked for
  double halo_px = 5;
  std::optional<ClearanceRamp> clearance{};
  std::vector<ContactMark> contacts{};
  std::vector<RayMark> ray_marks{};
  SightOptions sight{};
};

/// The lines of a drawing, by what became of them.
struct Drawing {
  Picture picture;
  Camera camera;
  std::vector<Segment> segments;
  std::vector<Piece> pieces;
  std::vector<Crossing> crossings;  // haloed only
  double bias_m = 0;                // of the lines before the surfaces, in the middle of the scene
};

/// Stroke width of a contact's ring: grows with depth, never twice the same for two depths that differ to the eye.
double contact_width_px(double depth_m, double scene_m);

/// Draws what is shown; visibility, tones and clearance by the rays. Throws Error. The rays see the newest state each:
/// what moves meanwhile is drawn where it was.
Drawing draw(const ShownObjects& shown, const DrawOptions& options, Rays& rays);

}  // namespace collided::draw
