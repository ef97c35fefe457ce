#include "tests/oracle/exact_oracle.hpp"

#include <cmath>

namespace collided::oracle {
using namespace engine;
namespace {

Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point operator*(const Rational& s, const Point& v) { return {s * v[0], s * v[1], s * v[2]}; }
Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

using Matrix = std::vector<std::vector<Rational>>;

/// Gauss elimination of an augmented matrix; nothing if singular.
std::optional<std::vector<Rational>> solve(Matrix m) {
  const std::size_t size = m.size();
  for (std::size_t column = 0; column < size; ++column) {
    std::size_t pivot = column;
    while (pivot < size && m[pivot][column] == 0) ++pivot;
    if (pivot == size) return std::nullopt;
    std::swap(m[pivot], m[column]);
    for (std::size_t row = 0; row < size; ++row) {
      if (row == column || m[row][column] == 0) continue;
      const Rational factor = m[row][column] / m[column][column];
      for (std::size_t k = column; k <= size; ++k) m[row][k] -= factor * m[column][k];
    }
  }
  std::vector<Rational> solution(size);
  for (std::size_t row = 0; row < size; ++row) solution[row] = m[row][size] / m[row][row];
  return solution;
}

bool allowed(const Face& face, const Rational* parameter) {
  Rational sum = 0;
  for (std::size_t i = 0; i < face.directions.size(); ++i) {
    if (parameter[i] < 0) return false;
    if (!face.endless && parameter[i] > 1) return false;
    sum += parameter[i];
  }
  return !face.simplex || sum <= 1;
}

/// Squared distance of the two flats through the faces, if it is taken inside both.
std::optional<Rational> face_distance(const Face& a, const Face& b) {
  std::vector<Point> columns;
  for (const Point& d : a.directions) columns.push_back(d);
  for (const Point& d : b.directions) columns.push_back(Rational(-1) * d);
  const Point gap = a.origin - b.origin;
  Matrix normal(columns.size(), std::vector<Rational>(columns.size() + 1));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) normal[i][j] = dot(columns[i], columns[j]);
    normal[i][columns.size()] = -dot(columns[i], gap);
  }
  const auto parameters = solve(std::move(normal));
  if (!parameters) return std::nullopt;
  if (!allowed(a, parameters->data()) || !allowed(b, parameters->data() + a.directions.size())) return std::nullopt;
  Point rest = gap;
  for (std::size_t i = 0; i < columns.size(); ++i) rest = rest + (*parameters)[i] * columns[i];
  return dot(rest, rest);
}

Figure ray_figure(const Ray& ray) {
  Figure result;
  result.faces.push_back({exact(ray.origin), {}, false, false});
  result.faces.push_back({exact(ray.origin), {exact(ray.direction)}, false, true});
  return result;
}

struct Span {
  Rational low = 0;
  Rational high = 1;
  bool empty = false;
};

/// Keeps the part of a + t d, t in the span, where value + t * slope <= 0.
void clip(Span& span, const Rational& value, const Rational& slope) {
  if (slope == 0) {
    if (value > 0) span.empty = true;
  } else {
    const Rational at = -value / slope;
    if (slope > 0 && at < span.high) span.high = at;
    if (slope < 0 && at > span.low) span.low = at;
  }
  if (span.low > span.high) span.empty = true;
}

/// Coordinates of a vector in the box's own axes.
Point in_axes(const Box& box, const Point& v) {
  Matrix m(3, std::vector<Rational>(4));
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[row][column] = Rational(box.axes(row, column));
    m[row][3] = v[row];
  }
  const auto solution = solve(std::move(m));
  return {(*solution)[0], (*solution)[1], (*solution)[2]};
}

void clip_by(Span& span, const Box& box, const Point& a, const Point& d) {
  const Point start = in_axes(box, a - exact(box.center));
  const Point step = in_axes(box, d);
  for (int i = 0; i < 3; ++i) {
    const Rational half(box.half_m[i]);
    clip(span, start[i] - half, step[i]);
    clip(span, -start[i] - half, -step[i]);
  }
}

std::vector<std::array<Point, 2>> edges(const Figure& f) {
  std::vector<std::array<Point, 2>> result;
  for (const Face& face : f.faces) {
    if (face.directions.size() == 1) result.push_back({face.origin, face.origin + face.directions[0]});
  }
  return result;
}

bool edge_meets(const Box& box, const std::array<Point, 2>& edge) {
  Span span;
  clip_by(span, box, edge[0], edge[1] - edge[0]);
  return !span.empty;
}

bool edge_meets(const Triangle& triangle, const std::array<Point, 2>& edge) {
  return squared_distance(segment_figure(edge[0], edge[1]), figure(triangle)) == 0;
}

template <class A, class B>
bool edges_decide(const A& a, const B& b, const Point& shift_b) {
  for (std::array<Point, 2> edge : edges(figure(b))) {
    if (edge_meets(a, {edge[0] + shift_b, edge[1] + shift_b})) return true;
  }
  for (std::array<Point, 2> edge : edges(figure(a))) {
    if (edge_meets(b, {edge[0] - shift_b, edge[1] - shift_b})) return true;
  }
  return false;
}

/// Rational bounds of sqrt(x), relative width about 2^-400; equal if x is the square of a rational.
std::array<Rational, 2> root_bounds(const Rational& x) {
  using Integer = boost::multiprecision::cpp_int;
  Integer n = numerator(x) * denominator(x);
  if (n == 0) return {0, 0};
  const unsigned shift = 400 + (msb(n) < 800 ? 800 : 0);
  n <<= 2 * shift;
  const Integer root = sqrt(n);
  const Rational scale = Rational(denominator(x)) * Rational(Integer(1) << shift);
  const bool perfect = root * root == n;
  return {Rational(root) / scale, Rational(perfect ? root : Integer(root + 1)) / scale};
}

bool within_length(const Rational& parameter, const Ray& ray) {
  if (std::isinf(ray.length_m)) return true;
  const Point d = exact(ray.direction);
  return parameter * parameter * dot(d, d) <= Rational(ray.length_m) * Rational(ray.length_m);
}

using WidePoint = std::array<Wide, 3>;
WidePoint wide(const Point& p) { return {Wide(p[0]), Wide(p[1]), Wide(p[2])}; }

}  // namespace

Point exact(const Vec3& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }

Figure figure(const Sphere& sphere) {
  Figure result;
  result.faces.push_back({exact(sphere.center), {}, false, false});
  result.radius = Rational(sphere.radius_m);
  return result;
}

Figure segment_figure(const Point& a, const Point& b) {
  Figure result;
  result.faces.push_back({a, {}, false, false});
  result.faces.push_back({b, {}, false, false});
  result.faces.push_back({a, {b - a}, false, false});
  return result;
}

Figure figure(const Capsule& capsule) {
  Figure result = segment_figure(exact(capsule.a), exact(capsule.b));
  result.radius = Rational(capsule.radius_m);
  return result;
}

Figure figure(const Triangle& t) {
  const Point corner[3] = {exact(t.a), exact(t.b), exact(t.c)};
  Figure result;
  for (int i = 0; i < 3; ++i) {
    result.faces.push_back({corner[i], {}, false, false});
    result.faces.push_back({corner[i], {corner[(i + 1) % 3] - corner[i]}, false, false});
  }
  result.faces.push_back({corner[0], {corner[1] - corner[0], corner[2] - corner[0]}, true, false});
  return result;
}

/// Each coordinate is at one end, at the other, or free: 27 faces.
Figure figure(const Box& box) {
  Figure result;
  for (int code = 0; code < 27; ++code) {
    const int choice[3] = {code % 3, code / 3 % 3, code / 9};
    Face face{exact(box.center), {}, false, false};
    for (int i = 0; i < 3; ++i) {
      const Point reach = Rational(box.half_m[i]) * exact(Vec3(box.axes.col(i)));
      face.origin = choice[i] == 1 ? face.origin + reach : face.origin - reach;
      if (choice[i] == 2) face.directions.push_back(Rational(2) * reach);
    }
    result.faces.push_back(face);
  }
  return result;
}

Rational squared_distance(const Figure& a, const Figure& b) {
  std::optional<Rational> least;
  for (const Face& face_a : a.faces) {
    for (const Face& face_b : b.faces) {
      const auto candidate = face_distance(face_a, face_b);
      if (candidate && (!least || *candidate < *least)) least = candidate;
    }
  }
  return *least;
}

bool overlaps(const Figure& a, const Figure& b) {
  const Rational reach = a.radius + b.radius;
  return squared_distance(a, b) <= reach * reach;
}

bool overlaps_by_clipping(const Box& a, const Box& b, const Point& shift_b) { return edges_decide(a, b, shift_b); }
bool overlaps_by_clipping(const Box& a, const Triangle& b, const Point& shift_b) { return edges_decide(a, b, shift_b); }
bool overlaps_by_clipping(const Triangle& a, const Triangle& b, const Point& shift_b) {
  return edges_decide(a, b, shift_b);
}

Wide distance(const Figure& a, const Figure& b) {
  const Wide apart = sqrt(Wide(squared_distance(a, b))) - Wide(a.radius + b.radius);
  return apart > 0 ? apart : Wide(0);
}

Point turned(const Quat& q, const Point& v) {
  const Point u{Rational(q.x()), Rational(q.y()), Rational(q.z())};
  const Rational w(q.w());
  const Point across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const Point sum = (w * w - dot(u, u)) * v + Rational(2 * dot(u, v)) * u + Rational(2 * w) * across;
  return Rational(1 / Rational(w * w + dot(u, u))) * sum;
}

Point turned_back(const Quat& q, const Point& v) { return turned(q.conjugate(), v); }

Figure placed(Figure figure, const Pose& pose) {
  for (Face& face : figure.faces) {
    face.origin = turned(pose.rotation, face.origin) + exact(pose.position);
    for (Point& direction : face.directions) direction = turned(pose.rotation, direction);
  }
  return figure;
}

Figure swept(const Figure& figure, const Point& way) {
  Figure result = figure;
  for (Face face : figure.faces) {
    // What is inside at first is passed by the border, or stays inside.
    if (face.directions.size() < 3) {
      Face passed = face;
      passed.directions.push_back(way);
      result.faces.push_back(passed);
    }
    face.origin = face.origin + way;
    result.faces.push_back(face);
  }
  return result;
}

Figure shifted(Figure figure, const Point& by) {
  for (Face& face : figure.faces) face.origin = face.origin + by;
  return figure;
}

double part_length(const Figure& a, const Figure& b) {
  std::vector<Point> differences;
  for (const Face& face_a : a.faces) {
    for (const Face& face_b : b.faces) {
      if (!face_a.directions.empty() || !face_b.directions.empty()) continue;
      differences.push_back(face_a.origin - face_b.origin);
    }
  }
  // To a size near 1, so that tiny figures do not underflow.
  Rational largest = 0;
  for (const Point& p : differences) {
    for (const Rational& x : p) largest = std::max<Rational>(largest, abs(x));
  }
  if (largest == 0) return 0;
  std::vector<Vec3> points;
  for (const Point& p : differences) {
    Vec3 point;
    for (int k = 0; k < 3; ++k) point[k] = static_cast<double>(Rational(p[k] / largest));
    points.push_back(point);
  }
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, (p - points[0]).norm());
  const double slack = 1e-10 * size;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const Vec3 n = (points[j] - points[i]).cross(points[k] - points[i]);
        if (n.norm() <= 1e-9 * size * size) continue;
        const Vec3 unit = n.normalized();
        double low = 0;
        double high = 0;
        for (const Vec3& p : points) {
          const double height = unit.dot(p - points[i]);
          low = std::min(low, height);
          high = std::max(high, height);
          if (low < -slack && high > slack) break;
        }
        if (low < -slack && high > slack) continue;
        least = std::min(least, std::abs(unit.dot(points[i])));
      }
    }
  }
  return std::isinf(least) ? 0.0 : static_cast<double>(Rational(Rational(least) * largest));
}

std::optional<Rational> first_parameter(const Ray& ray, const Triangle& triangle) {
  const Point o = exact(ray.origin);
  const Point d = exact(ray.direction);
  std::optional<Rational> first;
  const auto consider = [&](const Rational& s) {
    if (s >= 0 && within_length(s, ray) && (!first || s < *first)) first = s;
  };
  const Figure shape = figure(triangle);
  if (squared_distance(figure(Sphere{ray.origin, 0}), shape) == 0) return Rational(0);
  for (const Face& face : shape.faces) {
    // o + s d = origin + sum of u_i direction_i, by least squares; a point of both has no rest.
    std::vector<Point> columns{d};
    for (const Point& direction : face.directions) columns.push_back(Rational(-1) * direction);
    const Point gap = o - face.origin;
    Matrix normal(columns.size(), std::vector<Rational>(columns.size() + 1));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (std::size_t j = 0; j < columns.size(); ++j) normal[i][j] = dot(columns[i], columns[j]);
      normal[i][columns.size()] = -dot(columns[i], gap);
    }
    const auto parameters = solve(std::move(normal));
    if (!parameters || !allowed(face, parameters->data() + 1)) continue;
    Point rest = gap;
    for (std::size_t i = 0; i < columns.size(); ++i) rest = rest + (*parameters)[i] * columns[i];
    if (dot(rest, rest) == 0) consider((*parameters)[0]);
  }
  return first;
}

std::optional<Rational> first_parameter(const Ray& ray, const Box& box) {
  Span span;
  const Point start = in_axes(box, exact(ray.origin) - exact(box.center));
  const Point step = in_axes(box, exact(ray.direction));
  // No bound above yet: large enough for every face, made exact by the clips that follow.
  span.high = 1;
  for (int i = 0; i < 3; ++i) {
    if (step[i] == 0) continue;
    const Rational reach = (abs(start[i]) + Rational(box.half_m[i])) / abs(step[i]);
    if (reach > span.high) span.high = reach;
  }
  for (int i = 0; i < 3; ++i) {
    const Rational half(box.half_m[i]);
    clip(span, start[i] - half, step[i]);
    clip(span, -start[i] - half, -step[i]);
  }
  if (span.empty || !within_length(span.low, ray)) return std::nullopt;
  return span.low;
}

bool ray_meets(const Ray& ray, const Figure& solid) {
  const Rational reach2 = solid.radius * solid.radius;
  if (std::isinf(ray.length_m)) return squared_distance(ray_figure(ray), solid) <= reach2;
  const Point o = exact(ray.origin);
  const Point d = exact(ray.direction);
  const auto root = root_bounds(dot(d, d));
  const Rational length(ray.length_m);
  const auto meets_until = [&](const Rational& s) {
    return squared_distance(segment_figure(o, o + s * d), solid) <= reach2;
  };
  const bool surely = meets_until(length / root[1]);
  if (!surely && meets_until(length / root[0])) throw std::runtime_error("the oracle cannot decide this length");
  return surely;
}

Wide length(const Vec3& v) {
  const Point p = exact(v);
  return sqrt(Wide(dot(p, p)));
}

namespace {

/// Distance from a point to the core of a ball or capsule, in 100 digits.
Wide core_distance(const Figure& solid, const WidePoint& p) {
  const WidePoint a = wide(solid.faces[0].origin);
  WidePoint w{p[0] - a[0], p[1] - a[1], p[2] - a[2]};
  if (solid.faces.size() > 1) {
    const WidePoint d = wide(solid.faces[2].directions[0]);
    const Wide dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    Wide t = dd == 0 ? Wide(0) : Wide((w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / dd);
    if (t < 0) t = 0;
    if (t > 1) t = 1;
    for (int k = 0; k < 3; ++k) w[k] -= t * d[k];
  }
  return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

}  // namespace

Wide first_distance(const Ray& ray, const Figure& solid) {
  const WidePoint o = wide(exact(ray.origin));
  const WidePoint d = wide(exact(ray.direction));
  const Wide speed = length(ray.direction);
  const Wide radius(solid.radius);
  const auto above = [&](const Wide& s) {
    return core_distance(solid, {o[0] + s * d[0], o[1] + s * d[1], o[2] + s * d[2]}) - radius;
  };
  if (above(0) <= 0) return 0;
  // Convex along the ray: find the lowest point, then the crossing before it.
  Wide low = 0;
  Wide high = 4 * (above(0) + radius) / speed + 4 * length(Vec3::Ones());
  for (const Face& face : solid.faces) {
    for (int k = 0; k < 3; ++k) high += 2 * abs(wide(face.origin)[k] - o[k]) / speed;
  }
  for (int i = 0; i < 900; ++i) {
    const Wide left = low + (high - low) * Wide(0.45);
    const Wide right = low + (high - low) * Wide(0.55);
    (above(left) < above(right) ? high : low) = above(left) < above(right) ? right : left;
  }
  const Wide lowest = (low + high) / 2;
  if (above(lowest) >= 0) return lowest * speed;
  low = 0;
  high = lowest;
  for (int i = 0; i < 400; ++i) {
    const Wide middle = (low + high) / 2;
    (above(middle) <= 0 ? high : low) = middle;
  }
  return high * speed;
}

}  // namespace collided::oracle
