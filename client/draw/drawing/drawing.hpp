#pragma once

#include <optional>
#include <vector>

#include "client/draw/drawing/halo.hpp"
#include "client/draw/drawing/picture.hpp"
#include "client/draw/drawing/tones.hpp"

namespace collided::draw {

/// How lines and surfaces are drawn.
enum class Style { wireframe, hidden_line, obscured_line, haloed, toon, hatched };

/// A point where two objects touch.
struct ContactMark {
  Vec3 point;
  Vec3 normal;
  double depth_m = 0;
};

/// A ray to draw, up to its hit or to the edge of the picture.
struct RayMark {
  Vec3 origin;
  Vec3 end;
  bool is_hit = false;
};

/// The outline of a standing question, drawn as dashed lines over everything.
struct StandingMark {
  std::vector<std::vector<Vec3>> lines;  // in the world
  bool is_held = false;                  // the question holds an object
  bool is_endless = false;               // the picture need not show all of its lines
};

/// What to draw besides the scene, and how.
struct DrawOptions {
  View view{};
  Style style = Style::hidden_line;
  int tones = 3;                       // number of them, for the toon style
  std::optional<Vec3> toward_light{};  // in the world, any length; none: light comes from above and left of the eye
  double crease_cosine = 0.866;        // as in the ShapesOptions of the scene
  double halo_px = 5;
  std::optional<ClearanceRamp> clearance{};
  std::vector<ContactMark> contacts{};
  std::vector<RayMark> ray_marks{};
  std::vector<StandingMark> standing{};
  SightOptions sight{};
};

/// A drawing, and the lines and decisions that it was made from.
struct Drawing {
  Picture picture;
  Camera camera;
  std::vector<LineSegment> segments;
  std::vector<Piece> pieces;
  std::vector<LineCrossing> crossings;  // for the haloed style only
  double bias_m = 0;                    // by which lines are in front of surfaces, in the middle of the scene
};

/// The stroke width of a contact's ring. It grows with the depth, so that visibly different depths have different
/// widths.
double contact_width_px(double depth_m, double scene_m);

/// Draws the objects. Visibility, tones and clearance come from questions to the server, about its newest state each
/// time; an object that moves meanwhile is drawn at its pose in `shown`. Throws Error.
Drawing draw(const ShownObjects& shown, const DrawOptions& options, Rays& rays);

}  // namespace collided::draw
