#include <algorithm>
#include <array>
#include <cmath>

#include "server/geometry/tolerance.hpp"
#include "server/intake/mesh/tessellate.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kMostDegree = 8;

/// Clamped uniform knots: 0 for the first degree + 1, then 1, 2, ... up to the number of spans.
double knot(std::size_t i, std::size_t degree, std::size_t count) {
  const std::size_t spans = count - degree;
  return static_cast<double>(i <= degree ? 0 : std::min(i - degree, spans));
}

/// The point of a B-spline curve at a parameter, by de Boor's algorithm.
/// source  de Boor, "On calculating with B-splines", 1972
Vec3 curve_point(const Vec3* points, std::size_t degree, std::size_t count, double at) {
  const std::size_t spans = count - degree;
  const auto span = static_cast<std::size_t>(std::clamp(std::floor(at), 0.0, static_cast<double>(spans - 1)));
  std::array<Vec3, kMostDegree + 1> d;
  for (std::size_t i = 0; i <= degree; ++i) d[i] = points[span + i];
  for (std::size_t round = 1; round <= degree; ++round) {
    for (std::size_t i = degree; i >= round; --i) {
      const double low = knot(span + i, degree, count);
      const double high = knot(span + i + 1 + degree - round, degree, count);
      const double share = (at - low) / (high - low);
      d[i] = (1 - share) * d[i - 1] + share * d[i];
    }
  }
  return d[degree];
}

/// Control points, row by row.
struct ControlGrid {
  std::vector<Vec3> points;
  std::size_t columns;
  std::size_t rows;
};

/// The control points of the derivative along the rows. The spline had that degree before `order` earlier derivatives.
ControlGrid derivative(const ControlGrid& from, std::size_t degree, std::size_t order) {
  ControlGrid to{{}, from.columns - 1, from.rows};
  const std::size_t left = degree - order;  // of the degree
  const std::size_t count = from.columns + order;
  for (std::size_t row = 0; row < from.rows; ++row) {
    for (std::size_t i = 0; i + 1 < from.columns; ++i) {
      const double width = knot(i + order + left + 1, degree, count) - knot(i + order + 1, degree, count);
      const Vec3 step = from.points[row * from.columns + i + 1] - from.points[row * from.columns + i];
      to.points.push_back(width > 0 ? Vec3(static_cast<double>(left) / width * step) : Vec3::Zero());
    }
  }
  return to;
}

ControlGrid transposed(const ControlGrid& from) {
  ControlGrid to{{}, from.rows, from.columns};
  for (std::size_t column = 0; column < from.columns; ++column) {
    for (std::size_t row = 0; row < from.rows; ++row) to.points.push_back(from.points[row * from.columns + column]);
  }
  return to;
}

/// The largest length of a control point, which bounds the spline, since it lies in their convex hull.
double longest(const ControlGrid& grid) {
  double length = 0;
  for (const Vec3& point : grid.points) length = std::max(length, point.norm());
  return length * (1 + kBoundSlack);
}

double second_derivative(const ControlGrid& grid, std::size_t degree) {
  return degree < 2 ? 0 : longest(derivative(derivative(grid, degree, 0), degree, 1));
}

}  // namespace

Vec3 SplinePatch::at(double first, double second) const {
  std::vector<Vec3> across;
  for (unsigned row = 0; row < rows(); ++row)
    across.push_back(curve_point(points.data() + row * columns, first_degree, columns, first));
  return curve_point(across.data(), second_degree, rows(), second);
}

SecondDerivatives SplinePatch::second_derivatives() const {
  const ControlGrid grid{points, columns, rows()};
  const ControlGrid turned = transposed(grid);
  const ControlGrid both = derivative(transposed(derivative(grid, first_degree, 0)), second_degree, 0);
  return {second_derivative(grid, first_degree), longest(both), second_derivative(turned, second_degree)};
}

}  // namespace collided::engine
