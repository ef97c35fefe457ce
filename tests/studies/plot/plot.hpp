#pragma once

#include <optional>
#include <string>
#include <vector>

namespace collided::draw {

// The project's plots as SVG text: self-contained, and the same bytes for the same data. Texts are placed by their
// measured boxes: a tick, name or label that would cover another is moved or, for ticks, left out.

enum class Scale { linear, logarithmic };

/// Ends that are not given are chosen so that all data are inside. Values <= 0 on a logarithmic axis are drawn on the
/// frame at its low end, where a tick says "0".
struct Axis {
  std::string label;
  Scale scale = Scale::linear;
  std::optional<double> low = std::nullopt;
  std::optional<double> high = std::nullopt;
};

struct Point {
  double x = 0;
  double y = 0;
  std::string label{};  // written beside the mark where there is room, else at the end of a thin line
  double x_low = 0;     // a bar from x_low to x_high when they differ
  double x_high = 0;
};

enum class Paint { accent, palette, quiet };

struct Series {
  std::string name;
  std::vector<Point> points{};
  Paint paint = Paint::palette;  // accent: ours
  bool joined = true;            // by a line, in the order of the points
  bool marked = true;
  bool dashed = false;
  bool hollow = false;
};

struct Plot {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series{};
  double width = 860;
  double height = 470;
};

/// Horizontal bars, one group a row; a missing value says "no data".
struct Bars {
  std::string title;
  Axis value;
  std::vector<std::string> series{};  // the first is ours
  struct Group {
    std::string name;
    std::vector<std::optional<double>> values{};
  };
  std::vector<Group> groups{};
  double width = 860;
};

/// One strip a row, cut into parts one after the other: what a whole is made of. Each part has its share written in it where
/// there is room; the whole is written behind.
struct Strips {
  std::string title;
  std::vector<std::string> parts{};
  struct Row {
    std::string name;
    std::vector<double> values{};  // one a part, none below 0
    std::string whole{};
  };
  std::vector<Row> rows{};
  double width = 860;
};

/// Cells coloured by the logarithm of their value, each with its text; empty cells are hatched as "no data".
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
  double low = 1e-17;         // value drawn as paper
  double high = 1;            // value drawn in full colour
  std::string legend{};
  double width = 860;
};

std::string svg(const Plot& plot);
std::string svg(const Bars& bars);
std::string svg(const Strips& strips);
std::string svg(const HeatMap& map);

}  // namespace collided::draw
