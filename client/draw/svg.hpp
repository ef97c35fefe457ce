#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::draw {

/// Colours: paper, ink, one accent for this project's data, and six colours that colour-blind readers can distinguish.
/// source  Okabe, Ito, "Color Universal Design", 2008
inline constexpr const char* kPaper = "#fbfaf6";
inline constexpr const char* kInk = "#1d1d1b";
inline constexpr const char* kFaint = "#d9d6cc";
inline constexpr const char* kQuiet = "#6b6860";
inline constexpr const char* kAccent = "#c8450c";
inline constexpr const char* kPalette[] = {"#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#5b5b5b"};
inline constexpr int kPaletteSize = 6;

/// A rectangle in pixels, y downward.
struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  bool overlaps(const Rectangle& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
  bool contains(const Rectangle& o) const {
    return o.x >= x && o.y >= y && o.x + o.width <= x + width && o.y + o.height <= y + height;
  }
};

/// Which point of a text is placed.
enum class Anchor { start, middle, end };

/// Width of a text in pixels in the widest of the common sans-serif fonts (DejaVu Sans), so that texts placed by it do
/// not overlap in a narrower one either.
double text_width(std::string_view text, double size_px);

/// The bounding rectangle of a text whose base line starts, is centred or ends at (x, y).
Rectangle text_box(double x, double y, std::string_view text, double size_px, Anchor anchor);

/// The text with XML's reserved characters escaped.
std::string escaped(std::string_view text);

/// A pixel coordinate as text: two digits after the point in every locale, and no minus before zero.
std::string pixels(double value);

/// "1e-6" for powers of ten and small or large numbers, "0.25" for the others.
std::string tick_text(double value);

/// The text broken at blanks into lines no wider than width_px.
std::vector<std::string> wrapped(std::string_view text, double size_px, double width_px);

/// An SVG under construction. It remembers the rectangle of every text and mark, so that later items can avoid them.
/// The same calls give the same bytes. One thread.
class Canvas {
 public:
  Canvas(double width, double height, std::string_view title);

  void line(double x0, double y0, double x1, double y1, const char* color, double width, const char* dash = nullptr);
  void polyline(const std::vector<std::pair<double, double>>& points, const char* color, double width,
                const char* dash = nullptr);
  /// A filled polygon. Its edges are drawn in the same colour, so that neighbours leave no gap.
  void polygon(const std::vector<std::pair<double, double>>& points, const std::string& color);
  void rectangle(const Rectangle& r, const char* fill, const char* stroke = nullptr);
  void text(double x, double y, std::string_view content, double size_px, Anchor anchor, const char* color = kInk,
            bool bold = false);
  void vertical_text(double x, double y, std::string_view content, double size_px, const char* color = kInk);
  /// A mark of one of six shapes; 0 is round.
  /// hollow  outline only
  void mark(double x, double y, int shape, const char* color, bool hollow = false);

  /// Whether the rectangle overlaps no placed item.
  bool is_free(const Rectangle& r) const;
  void occupy(const Rectangle& r) { occupied_.push_back(r); }

  double width() const { return width_; }
  double height() const { return height_; }
  std::string finish() &&;

 private:
  double width_;
  double height_;
  std::string body_;
  std::vector<Rectangle> occupied_;
};

/// Writes the title in bold at the top, in as many lines as it needs. Returns the y below which the drawing has room.
double draw_title(Canvas& canvas, std::string_view title);

}  // namespace collided::draw
