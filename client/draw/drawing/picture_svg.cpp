#include <map>

#include "client/draw/drawing/picture.hpp"
#include "client/draw/svg.hpp"

namespace collided::draw {
namespace {

/// A point as text, to a hundredth of a pixel.
std::string spot(const Spot& p) { return pixels(p[0]) + ' ' + pixels(p[1]); }

/// The pixels of one colour as rectangles. Adjacent pixels of a row make a run, and equal runs of successive rows one
/// rectangle.
std::string rectangles(const Pixels& shown, std::uint8_t number) {
  struct Run {
    int x, width, y, height;
  };
  std::map<std::pair<int, int>, Run> open;  // by (x, width), of the row before
  std::string path;
  const auto close = [&](const Run& r) {
    path += "M" + std::to_string(r.x) + ' ' + std::to_string(r.y) + "h" + std::to_string(r.width) + "v" +
            std::to_string(r.height) + "h" + std::to_string(-r.width) + "z";
  };
  for (int y = 0; y <= shown.height; ++y) {
    std::map<std::pair<int, int>, Run> now;
    for (int x = 0; y < shown.height && x < shown.width;) {
      const std::uint8_t* row = shown.numbers.data() + static_cast<std::size_t>(y) * shown.width;
      const int first = x;
      while (x < shown.width && row[x] == row[first]) ++x;
      if (row[first] != number) continue;
      const auto above = open.find({first, x - first});
      now[{first, x - first}] = above != open.end() ? Run{first, x - first, above->second.y, above->second.height + 1}
                                                    : Run{first, x - first, y, 1};
      if (above != open.end()) open.erase(above);
    }
    for (const auto& [key, run] : open) close(run);
    open = std::move(now);
  }
  return path;
}

std::string painted_pixels(const Pixels& shown) {
  std::string body;
  for (std::size_t i = 0; i < shown.colors.size(); ++i) {
    const std::string path = rectangles(shown, static_cast<std::uint8_t>(i));
    if (path.empty()) continue;
    body +=
        "<path class=\"tone\" shape-rendering=\"crispEdges\" fill=\"" + shown.colors[i] + "\" d=\"" + path + "\"/>\n";
  }
  return body;
}

}  // namespace

std::string as_svg(const Picture& picture) {
  const std::string width = pixels(picture.width_px);
  const std::string height = pixels(picture.height_px);
  std::string body = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height +
                     "\" viewBox=\"0 0 " + width + ' ' + height + "\">\n<title>" + escaped(picture.title) +
                     "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"" +
                     (picture.is_black_and_white ? "#ffffff" : kPaper) + "\"/>\n";
  if (picture.pixels) body += painted_pixels(*picture.pixels);
  body += "<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
  for (std::size_t i = 0; i < picture.strokes.size();) {
    const Ink& ink = picture.strokes[i].ink;
    body += "<path class=\"" + escaped(ink.name) + "\" stroke=\"" + ink.color + "\" stroke-width=\"" +
            pixels(ink.width_px) + "\" d=\"";
    for (; i < picture.strokes.size() && picture.strokes[i].ink == ink; ++i) {
      const std::vector<Spot>& points = picture.strokes[i].points;
      for (std::size_t k = 0; k < points.size(); ++k) body += (k == 0 ? 'M' : 'L') + spot(points[k]);
    }
    body += "\"/>\n";
  }
  for (const CircleMark& ring : picture.rings) {
    body += "<circle class=\"" + escaped(ring.ink.name) + "\" cx=\"" + pixels(ring.center[0]) + "\" cy=\"" +
            pixels(ring.center[1]) + "\" r=\"" + pixels(ring.radius_px) + "\" stroke=\"" + ring.ink.color +
            "\" stroke-width=\"" + pixels(ring.ink.width_px) + "\"/>\n";
  }
  return body + "</g>\n</svg>\n";
}

}  // namespace collided::draw
