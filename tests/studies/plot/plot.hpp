#pragma once

#include <optional>
#include <string>
#include <vector>

namespace collided::draw {

// The project's plots as SVG text: self-contained, and the same bytes for the same data. Texts are placed by their
// measured boxes: a name or label that would cover another is moved, a tick that would is left out. Lengths are pixels.

enum class Scale { linear, logarithmic };

/// An axis. Ends that are not given are chosen so that all data are inside. Values of 0 or less on a logarithmic axis
/// are drawn on the frame at its low end, where a tick says "0".
struct Axis {
  std::string label;
  Scale scale = Scale::linear;
  std::optional<double> low = std::nullopt;
  std::optional<double> high = std::nullopt;
};

/// A data point.
struct Point {
  double x = 0;
  double y = 0;
  std::string label{};  // written beside the mark where there is room, else at the end of a thin line
  double x_low = 0;     // where x_low and x_high differ, a bar is drawn between them
  double x_high = 0;
};

/// accent: this project's data. palette: a colour for each series. quiet: grey.
enum class Paint { accent, palette, quiet };

/// Data points that belong together.
struct Series {
  std::string name;
  std::vector<Point> points{};
  Paint paint = Paint::palette;  // the colour
  bool joined = true;            // connected by a line, in the order of the points
  bool marked = true;
  bool dashed = false;
  bool hollow = false;
};

/// Series over two axes.
struct Plot {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series{};
  double width = 860;
  double height = 470;
};

/// Horizontal bars, one group for each row; a missing value is drawn as "no data".
struct Bars {
  std::string title;
  Axis value;
  std::vector<std::string> series{};  // the first is in the accent colour
  struct Group {
    std::string name;
    std::vector<std::optional<double>> values{};
  };
  std::vector<Group> groups{};
  double width = 860;
};

/// What wholes are made of: a strip for each row, divided into parts. The share of a part is written in it where there
/// is room; the whole is written after the strip.
struct Strips {
  std::string title;
  std::vector<std::string> parts{};
  struct Row {
    std::string name;
    std::vector<double> values{};  // one for each part, not negative
    std::string whole{};
  };
  std::vector<Row> rows{};
  double width = 860;
};

/// A table of cells coloured by the logarithm of their value, each with its text. Cells without a value are hatched as
/// "no data".
struct HeatMap {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<std::string> columns{};
  std::vector<std::string> rows{};
  struct Cell {
    std::optional<double> value{};
    std::string text{};
  };
  std::vector<Cell> cells{};  // row by row
  double low = 1e-17;         // value drawn in the colour of the paper
  double high = 1;            // value drawn in full colour
  std::string legend{};
  double width = 860;
};

/// Each as a whole SVG file.
std::string svg(const Plot& plot);
std::string svg(const Bars& bars);
std::string svg(const Strips& strips);
std::string svg(const HeatMap& map);

}  // namespace collided::draw
