#include "client/draw/drawing/drawing.hpp"

#include <algorithm>
#include <cmath>

#include "client/draw/svg.hpp"

namespace collided::draw {
namespace {

constexpr const char* kHiddenInk = "#b9b5a9";
constexpr const char* kContactInk = "#d01010";
constexpr const char* kBlack = "#000000";
constexpr double kRingRadius_px = 7;
constexpr double kNormal_px = 26;
constexpr double kHatchSpacing_px = 2.6;
constexpr double kDash_px = 6;  // of standing questions; the next is the gap between two
constexpr double kGap_px = 4;

const Ink& ink_of(LineKind kind) {
  static const Ink kInks[kLineKindCount] = {
      {"silhouette", kInk, 2.2}, {"boundary", kInk, 1.5}, {"crease", kInk, 1.1}, {"material", kInk, 0.7}};
  return kInks[static_cast<std::size_t>(kind)];
}

/// A colour "#rrggbb" between two others, by the fraction `share`.
std::string mixed(const std::string& from, const std::string& to, double share) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string color = "#";
  for (std::size_t k = 1; k < 7; k += 2) {
    const int a = std::stoi(from.substr(k, 2), nullptr, 16);
    const int b = std::stoi(to.substr(k, 2), nullptr, 16);
    const auto value = static_cast<std::size_t>(std::lround(a + share * (b - a)));
    color += {kDigits[value / 16], kDigits[value % 16]};
  }
  return color;
}

Spot spot_at(const LineSegment& s, double fraction) {
  return {s.image_a.x + fraction * (s.image_b.x - s.image_a.x), s.image_a.y + fraction * (s.image_b.y - s.image_a.y)};
}

/// Adds the visible or the hidden pieces as strokes. Successive pieces of one line make one stroke.
void add_strokes(const Drawing& drawing, bool seen, const Ink* ink, std::vector<Stroke>& strokes) {
  for (int kind = kLineKindCount - 1; kind >= 0; --kind) {
    std::uint32_t line = 0xffffffff;
    for (const Piece& piece : drawing.pieces) {
      const LineSegment& segment = drawing.segments[piece.segment];
      if (static_cast<int>(segment.kind) != kind || piece.is_seen != seen) continue;
      const Spot from = spot_at(segment, piece.from);
      const Spot to = spot_at(segment, piece.to);
      const bool follows =
          line == segment.line && !strokes.empty() &&
          std::hypot(strokes.back().points.back()[0] - from[0], strokes.back().points.back()[1] - from[1]) < 1e-6;
      if (!follows) strokes.push_back({{from}, ink != nullptr ? *ink : ink_of(segment.kind)});
      strokes.back().points.push_back(to);
      line = segment.line;
    }
  }
}

Vec3 light_of(const DrawOptions& options, const Camera& camera) {
  if (options.toward_light) return options.toward_light->normalized();
  return (-0.4 * camera.right() + 0.6 * camera.above() - 0.7 * camera.forward()).normalized();
}

void add_tones(const ShownObjects& shown, const DrawOptions& options, Rays& rays, Drawing& drawing) {
  const bool is_hatched = options.style == Style::hatched;
  ToneOptions tone{.tones = is_hatched ? 16 : options.tones,
                   .toward_light = light_of(options, drawing.camera),
                   .crease_cosine = options.crease_cosine,
                   .clearance = is_hatched ? std::nullopt : options.clearance};
  if (options.style != Style::toon && !is_hatched) tone.tones = 1;
  const ToneMap map = cast_tones(shown, drawing.camera, drawing.segments, tone, rays);
  if (is_hatched) {
    for (std::vector<Spot>& points : hatching(map, kHatchSpacing_px)) {
      drawing.picture.strokes.push_back({std::move(points), {"hatch", kBlack, 1}});
    }
    return;
  }
  Pixels pixels{map.width, map.height, map.numbers, {}};
  for (int i = 0; i < tone.tones; ++i) {
    pixels.colors.push_back(tone.tones == 1 ? kPaper
                                            : mixed("#8d877a", "#fffefb", static_cast<double>(i) / (tone.tones - 1)));
  }
  for (int i = 0; tone.clearance && i < tone.clearance->bands; ++i) {
    const double share = static_cast<double>(i) / std::max(1, tone.clearance->bands - 1);
    pixels.colors.push_back(mixed(kAccent, "#fbf0dc", share));
  }
  drawing.picture.pixels = std::move(pixels);
}

/// Adds a straight line of the world, clipped to the picture.
void add_line(const Vec3& a, const Vec3& b, const Ink& ink, Drawing& drawing) {
  const auto shown = drawing.camera.clip(a, b);
  if (!shown) return;
  const ImagePoint from = drawing.camera.project(a + shown->first * (b - a));
  const ImagePoint to = drawing.camera.project(a + shown->second * (b - a));
  drawing.picture.strokes.push_back({{{from.x, from.y}, {to.x, to.y}}, ink});
}

/// Adds a line of the world as dashes of equal length in the picture.
void add_dashes(const std::vector<Vec3>& line, const Ink& ink, Drawing& drawing) {
  constexpr double kPeriod_px = kDash_px + kGap_px;
  double walked_px = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto shown = drawing.camera.clip(line[i], line[i + 1]);
    if (!shown) continue;
    const ImagePoint from = drawing.camera.project(line[i] + shown->first * (line[i + 1] - line[i]));
    const ImagePoint to = drawing.camera.project(line[i] + shown->second * (line[i + 1] - line[i]));
    const double length_px = std::hypot(to.x - from.x, to.y - from.y);
    const auto at = [&](double px) {
      const double share = length_px > 0 ? px / length_px : 0;
      return Spot{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
    };
    for (double px = -std::fmod(walked_px, kPeriod_px); px < length_px; px += kPeriod_px) {
      const double begin = std::max(0.0, px);
      const double end = std::min(length_px, px + kDash_px);
      if (begin < end) drawing.picture.strokes.push_back({{at(begin), at(end)}, ink});
    }
    walked_px += length_px;
  }
}

void add_standing(const DrawOptions& options, Drawing& drawing) {
  const Ink empty{"fence", kQuiet, 1.1};
  const Ink held{"fence-entered", kAccent, 1.8};
  for (const StandingMark& mark : options.standing) {
    for (const std::vector<Vec3>& line : mark.lines) add_dashes(line, mark.is_held ? held : empty, drawing);
  }
}

void add_marks(const DrawOptions& options, double scene_m, Drawing& drawing) {
  const auto is_before = [&](const Vec3& p) {
    return drawing.camera.is_orthographic() || drawing.camera.project(p).depth_m > 0;
  };
  for (const RayMark& ray : options.ray_marks) {
    add_line(ray.origin, ray.end, {"ray", kAccent, 1.2}, drawing);
    if (!ray.is_hit || !is_before(ray.end)) continue;
    const ImagePoint end = drawing.camera.project(ray.end);
    drawing.picture.rings.push_back({{end.x, end.y}, 2, {"ray-hit", kAccent, 4}});
  }
  for (const ContactMark& contact : options.contacts) {
    if (!is_before(contact.point)) continue;
    const ImagePoint at = drawing.camera.project(contact.point);
    const double width = contact_width_px(contact.depth_m, scene_m);
    drawing.picture.rings.push_back({{at.x, at.y}, kRingRadius_px, {"contact", kContactInk, width}});
    const Vec3 tip = contact.point + kNormal_px * drawing.camera.pixel_m(contact.point) * contact.normal;
    add_line(contact.point, tip, {"normal", kContactInk, 1.2}, drawing);
  }
}

/// The points that must be in the picture.
std::vector<Vec3> with_standing(std::vector<Vec3> points, const DrawOptions& options) {
  for (const StandingMark& mark : options.standing) {
    if (mark.is_endless) continue;
    for (const std::vector<Vec3>& line : mark.lines) points.insert(points.end(), line.begin(), line.end());
  }
  return points;
}

void make_black_and_white(Picture& picture) {
  picture.is_black_and_white = true;
  for (Stroke& stroke : picture.strokes) stroke.ink.color = kBlack;
  for (CircleMark& ring : picture.rings) ring.ink.color = kBlack;
}

}  // namespace

double contact_width_px(double depth_m, double scene_m) {
  // The square root makes small depths distinguishable.
  return 1 + 4 * std::sqrt(depth_m / (depth_m + 0.1 * scene_m));
}

Drawing draw(const ShownObjects& shown, const DrawOptions& options, Rays& rays) {
  const std::vector<Vec3> extremes = extreme_points(shown);
  Drawing drawing{.picture = {},
                  .camera = Camera::fitted(options.view, with_standing(extremes, options)),
                  .segments = {},
                  .pieces = {},
                  .crossings = {},
                  .bias_m = 0};
  const Camera& camera = drawing.camera;
  // Written so that NaN, from coordinates whose squares overflow, is refused.
  if (!(camera.height_px() >= 1 && camera.height_px() <= 4 * camera.width_px())) {
    throw Error{ErrorCode::bad_input, "the scene is too large to be drawn: its coordinates have no squares in double",
                "--only draws a part of it"};
  }
  drawing.picture.width_px = camera.width_px();
  drawing.picture.height_px = camera.height_px();
  drawing.segments = segments_in_picture(feature_lines(shown, camera), camera);
  Eigen::AlignedBox3d bounds;
  for (const Vec3& p : extremes) bounds.extend(p);
  const double scene_m = extremes.empty() ? 1 : bounds.diagonal().norm();
  drawing.bias_m = extremes.empty() ? 0 : options.sight.bias_px * camera.pixel_m(bounds.center());

  const bool needs_sight = options.style != Style::wireframe && options.style != Style::haloed;
  if (needs_sight) {
    drawing.pieces = seen_pieces(drawing.segments, camera, rays, options.sight);
  } else if (options.style == Style::haloed) {
    drawing.crossings = crossings(drawing.segments, camera.is_orthographic());
    drawing.pieces = haloed_pieces(drawing.segments, drawing.crossings, options.halo_px);
  } else {
    for (std::uint32_t i = 0; i < drawing.segments.size(); ++i) drawing.pieces.push_back({i, 0, 1, true});
  }
  if (options.style == Style::toon || options.style == Style::hatched || options.clearance)
    add_tones(shown, options, rays, drawing);
  const Ink hidden{"hidden", kHiddenInk, 0.8};
  if (options.style == Style::obscured_line) add_strokes(drawing, false, &hidden, drawing.picture.strokes);
  add_strokes(drawing, true, nullptr, drawing.picture.strokes);
  add_standing(options, drawing);
  add_marks(options, scene_m, drawing);
  if (options.style == Style::hatched) make_black_and_white(drawing.picture);
  return drawing;
}

}  // namespace collided::draw
