#include "client/draw/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace collided::draw {
namespace {

std::string attribute(const char* name, double value) { return std::string(" ") + name + "=\"" + pixels(value) + "\""; }
std::string attribute(const char* name, std::string_view value) {
  return std::string(" ") + name + "=\"" + escaped(value) + "\"";
}

/// Whether a byte continues a UTF-8 character, so that it takes no width.
bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

double glyph_width(char c) {
  if (continues(c)) return 0;
  if (std::string_view("ijl.,:;'|!I ").find(c) != std::string_view::npos) return 0.36;
  if (std::string_view("frt()[]-/").find(c) != std::string_view::npos) return 0.43;
  if (std::string_view("mwMW%@").find(c) != std::string_view::npos) return 0.95;
  if (c >= 'A' && c <= 'Z') return 0.71;
  return 0.63;
}

std::string joined(const std::vector<std::pair<double, double>>& points) {
  std::string path;
  for (const auto& [x, y] : points) path += (path.empty() ? "" : " ") + pixels(x) + "," + pixels(y);
  return path;
}

}  // namespace

double text_width(std::string_view text, double size_px) {
  double em = 0;
  for (const char c : text) em += glyph_width(c);
  return em * size_px;
}

Rectangle text_box(double x, double y, std::string_view text, double size_px, Anchor anchor) {
  const double width = text_width(text, size_px);
  const double left = anchor == Anchor::start ? x : anchor == Anchor::middle ? x - width / 2 : x - width;
  return {left, y - 0.8 * size_px, width, 1.05 * size_px};
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string pixels(double value) {
  const long long hundredths = std::llround(value * 100);
  const unsigned long long size = static_cast<unsigned long long>(std::llabs(hundredths));
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%02llu", hundredths < 0 ? "-" : "", size / 100, size % 100);
  return text;
}

std::string tick_text(double value) {
  char text[40];
  if (value != 0 && (std::abs(value) >= 1e5 || std::abs(value) < 1e-3)) {
    const int power = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    std::snprintf(text, sizeof text, "%.3ge%d", value / std::pow(10.0, power), power);
  } else {
    std::snprintf(text, sizeof text, "%.6g", value);
  }
  return text;
}

std::vector<std::string> wrapped(std::string_view text, double size_px, double width_px) {
  std::vector<std::string> lines(1);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word(text.substr(begin, end - begin));
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (text_width(line + " " + word, size_px) <= width_px) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
    begin = end + 1;
  }
  return lines;
}

Canvas::Canvas(double width, double height, std::string_view title) : width_(width), height_(height) {
  body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + pixels(width) + " " + pixels(height) +
          "\" width=\"" + pixels(width) + "\" height=\"" + pixels(height) +
          "\" role=\"img\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n<title>" + escaped(title) +
          "</title>\n";
  rectangle({0, 0, width, height}, kPaper);
}

void Canvas::line(double x0, double y0, double x1, double y1, const char* color, double width, const char* dash) {
  body_ += "<line" + attribute("x1", x0) + attribute("y1", y0) + attribute("x2", x1) + attribute("y2", y1) +
           attribute("stroke", color) + attribute("stroke-width", width) +
           (dash ? attribute("stroke-dasharray", dash) : "") + "/>\n";
}

void Canvas::polyline(const std::vector<std::pair<double, double>>& points, const char* color, double width,
                      const char* dash) {
  if (points.size() < 2) return;
  body_ += "<polyline fill=\"none\" stroke-linejoin=\"round\"" + attribute("points", joined(points)) +
           attribute("stroke", color) + attribute("stroke-width", width) +
           (dash ? attribute("stroke-dasharray", dash) : "") + "/>\n";
}

void Canvas::polygon(const std::vector<std::pair<double, double>>& points, const std::string& color) {
  if (points.size() < 3) return;
  body_ += "<polygon stroke-width=\"0.3\" stroke-linejoin=\"round\"" + attribute("points", joined(points)) +
           attribute("fill", color) + attribute("stroke", color) + "/>\n";
}

void Canvas::rectangle(const Rectangle& r, const char* fill, const char* stroke) {
  body_ += "<rect" + attribute("x", r.x) + attribute("y", r.y) + attribute("width", r.width) +
           attribute("height", r.height) + attribute("fill", fill) + (stroke ? attribute("stroke", stroke) : "") +
           "/>\n";
}

void Canvas::text(double x, double y, std::string_view content, double size_px, Anchor anchor, const char* color,
                  bool bold) {
  static constexpr const char* kAnchors[] = {"start", "middle", "end"};
  occupy(text_box(x, y, content, size_px, anchor));
  body_ += "<text" + attribute("x", x) + attribute("y", y) + attribute("font-size", size_px) +
           attribute("text-anchor", kAnchors[static_cast<int>(anchor)]) + attribute("fill", color) +
           (bold ? " font-weight=\"bold\"" : "") + ">" + escaped(content) + "</text>\n";
}

void Canvas::vertical_text(double x, double y, std::string_view content, double size_px, const char* color) {
  const double length = text_width(content, size_px);
  occupy({x - size_px, y - length / 2, 1.3 * size_px, length});
  body_ += "<text transform=\"translate(" + pixels(x) + " " + pixels(y) + ") rotate(-90)\"" +
           attribute("font-size", size_px) + " text-anchor=\"middle\"" + attribute("fill", color) + ">" +
           escaped(content) + "</text>\n";
}

void Canvas::mark(double x, double y, int shape, const char* color, bool hollow) {
  occupy({x - 5, y - 5, 10, 10});
  const std::string paint =
      attribute("fill", hollow ? kPaper : color) + attribute("stroke", color) + attribute("stroke-width", 1.5) + "/>\n";
  const auto polygon = [&](std::string_view outline) {
    body_ += "<path transform=\"translate(" + pixels(x) + " " + pixels(y) + ")\"" + attribute("d", outline) + paint;
  };
  switch (shape % 6) {
    case 0: body_ += "<circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", 4.2) + paint; break;
    case 1: polygon("M-3.8-3.8H3.8V3.8H-3.8Z"); break;
    case 2: polygon("M0-5.2L5.2 0L0 5.2L-5.2 0Z"); break;
    case 3: polygon("M0-5L4.8 3.8H-4.8Z"); break;
    case 4: polygon("M0 5L4.8-3.8H-4.8Z"); break;
    default: polygon("M-1.5-5H1.5V-1.5H5V1.5H1.5V5H-1.5V1.5H-5V-1.5H-1.5Z");
  }
}

bool Canvas::is_free(const Rectangle& r) const {
  if (!Rectangle{0, 0, width_, height_}.contains(r)) return false;
  return std::none_of(occupied_.begin(), occupied_.end(), [&](const Rectangle& o) { return o.overlaps(r); });
}

double draw_title(Canvas& canvas, std::string_view title) {
  constexpr double kTitleSize = 15;
  double y = 22;
  for (const std::string& line : wrapped(title, kTitleSize, canvas.width() - 40)) {
    canvas.text(20, y, line, kTitleSize, Anchor::start, kInk, true);
    y += 20;
  }
  return y + 2;
}

std::string Canvas::finish() && { return std::move(body_) + "</svg>\n"; }

}  // namespace collided::draw
