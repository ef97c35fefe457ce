// Rays against implicit surfaces: yes or no, bracket, side and normal as by rationals, Sturm's theorem and expansion into
// monomials (oracle), for random polynomials and for those whose roots are planted where they are hard.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/intake/readers/polynomial_text.hpp"
#include "tests/oracle/implicit_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::implicit_ray_test {
namespace {

using oracle::Rational;
using oracle::RootCount;
using oracle::Trivariate;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Trivariate kX = Trivariate::variable(0);
const Trivariate kY = Trivariate::variable(1);
const Trivariate kZ = Trivariate::variable(2);

Trivariate power(const Trivariate& base, int exponent) {
  Trivariate result = 1;
  for (int i = 0; i < exponent; ++i) result = result * base;
  return result;
}

/// A surface as its user writes it, and as the oracle knows it.
struct Twin {
  std::string text;
  Trivariate exact;
};

/// 17 digits read back to the same double.
std::string written(double number) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", std::abs(number));
  return (number < 0 ? "0-" : "") + std::string(text.data());
}

Twin sphere(const Vec3& center, double radius) {
  Twin twin;
  const Trivariate variables[3] = {kX, kY, kZ};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string difference = std::string("(") + "xyz"[axis] + "-(" + written(center[axis]) + "))";
    twin.text += (axis > 0 ? "+" : "") + difference + "^2";
    twin.exact = twin.exact + power(variables[axis] - center[axis], 2);
  }
  twin.text += "-(" + written(radius) + ")^2";
  twin.exact = twin.exact - power(radius, 2);
  return twin;
}

Twin torus() {
  const Trivariate ring = kX * kX + kY * kY;
  return {"(x^2+y^2+z^2+3)^2 - 16*(x^2+y^2)", power(ring + kZ * kZ + 3, 2) - Trivariate(16) * ring};
}

/// Every monomial up to the degree, some left out.
Twin random_polynomial(int degree, std::mt19937_64& generator, const std::function<double()>& coefficient) {
  Twin twin;
  std::bernoulli_distribution kept(0.7);
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; i + j <= degree; ++j) {
      for (int k = 0; i + j + k <= degree; ++k) {
        // The highest power of z stays, so that the degree is the one asked.
        if (k != degree && !kept(generator)) continue;
        const double c = coefficient();
        // Dense ones of degree 8 would have more steps than are taken.
        if (degree > 6 && k != degree && k % 2 == 1) continue;
        twin.text += (twin.text.empty() ? "" : "+") + std::string("(") + written(c) + ")";
        if (i > 0) twin.text += "*x^" + std::to_string(i);
        if (j > 0) twin.text += "*y^" + std::to_string(j);
        if (k > 0) twin.text += "*z^" + std::to_string(k);
        twin.exact.add({i, j, k}, Rational(c));
      }
    }
  }
  return twin;
}

/// What the oracle knows of a ray, worked out once for several answers.
struct Truth {
  std::vector<Rational> along;
  std::optional<oracle::Stay> stay;  // where an answer may be, the length applied; no end where f is zero all along
  std::optional<RootCount> roots;    // unless f is zero all along
  bool is_met = false;
};

/// The end of a ray by its length: exact where the length of its direction is rational, else to 600 bits.
std::pair<Rational, bool> end_of(const Ray& ray) {
  using boost::multiprecision::cpp_int;
  Rational square = 0;
  for (const double d : ray.direction) square += Rational(d) * Rational(d);
  const Rational limit = Rational(ray.length_m) * Rational(ray.length_m) / square;
  const cpp_int scaled = (boost::multiprecision::numerator(limit) << 1200) / boost::multiprecision::denominator(limit);
  const Rational end = Rational(boost::multiprecision::sqrt(scaled)) / Rational(cpp_int(1) << 600);
  return {end, end * end == limit};
}

Truth truth_of(const Ray& ray, const Twin& twin, const ImplicitSurface& surface) {
  Truth truth{twin.exact.along(ray), oracle::stay_in_box(ray, surface.low, surface.high), {}, false};
  if (!truth.stay) return truth;
  bool end_is_exact = true;
  if (std::isfinite(ray.length_m)) {
    const auto [end, exact] = end_of(ray);
    if (!truth.stay->last || end < *truth.stay->last) {
      truth.stay->last = end;
      end_is_exact = exact;
    }
  }
  if (truth.stay->last && *truth.stay->last < truth.stay->first) {
    truth.stay.reset();
    return truth;
  }
  truth.is_met = truth.along.empty();
  if (truth.is_met) return truth;
  if (!truth.stay->last) {
    // Beyond Cauchy's bound there is no root.
    Rational largest = 0;
    for (const Rational& c : truth.along) largest = std::max(largest, Rational(abs(c)));
    truth.stay->last = truth.stay->first + largest / abs(truth.along.back()) + 1;
  }
  truth.roots.emplace(truth.along);
  const Rational& last = *truth.stay->last;
  const Rational beyond = last + Rational(1) / Rational(boost::multiprecision::cpp_int(1) << 600);
  EXPECT_TRUE(end_is_exact || truth.roots->within(last, beyond) == (truth.roots->is_root(last) ? 1 : 0))
      << "too near to the end for the oracle";
  truth.is_met = truth.roots->within(truth.stay->first, last) > 0;
  return truth;
}

/// Holds an answer against the truth.
void expect_true(const Truth& truth, const ExactResult& verdict, const ImplicitHit& hit) {
  ASSERT_NE(verdict.decision, Decision::undecided);
  ASSERT_EQ(verdict.yes(), truth.is_met);
  if (!verdict.yes()) return;
  ASSERT_LE(hit.low, hit.high);
  ASSERT_TRUE(std::isfinite(hit.low));
  const oracle::Stay& stay = *truth.stay;
  EXPECT_EQ(hit.runs_along, truth.along.empty());
  if (truth.along.empty()) {
    EXPECT_TRUE(Rational(hit.low) <= stay.first && (std::isinf(hit.high) || stay.first <= Rational(hit.high)));
    return;
  }
  const Rational low = std::max(stay.first, Rational(hit.low));
  const Rational high = std::isfinite(hit.high) ? std::min(*stay.last, Rational(hit.high)) : *stay.last;
  ASSERT_LE(low, high);
  EXPECT_EQ(low > stay.first ? truth.roots->before(stay.first, low) : 0, 0) << "an earlier root";
  EXPECT_GE(truth.roots->within(low, high), 1) << "no root in [" << hit.low << ", " << hit.high << "]";
}

/// The normal against the gradient at a point of the ray that is off the surface by 2^-100 of its coordinates.
void expect_normal(const Ray& ray, const Twin& twin, const Truth& truth, const ImplicitHit& hit) {
  if (hit.normal_state != ImplicitHit::Normal::known || truth.along.empty() || !std::isfinite(hit.high)) return;
  Rational low(hit.low), high(hit.high);
  const Rational at_low = oracle::value_at(truth.along, low);
  const bool changes = at_low * oracle::value_at(truth.along, high) < 0;
  const Rational fine = Rational(1) / Rational(boost::multiprecision::cpp_int(1) << 100);
  oracle::Point point;
  for (int step = 0; step < 1200; ++step) {
    Rational moved = 0, size = 0;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = Rational(ray.origin[axis]) + high * Rational(ray.direction[axis]);
      moved = std::max(moved, Rational((high - low) * abs(Rational(ray.direction[axis]))));
      size = std::max(size, Rational(abs(point[axis])));
    }
    if (moved <= size * fine) break;
    const Rational middle = (low + high) / 2;
    const bool below =
        changes ? at_low * oracle::value_at(truth.along, middle) <= 0 : truth.roots->within(low, middle) > 0;
    (below ? high : low) = middle;
  }
  std::array<oracle::Wide, 3> gradient;
  oracle::Wide square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis] = oracle::Wide(twin.exact.derivative(axis).at(point));
    square += gradient[axis] * gradient[axis];
  }
  oracle::Wide off = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const oracle::Wide difference = gradient[axis] / sqrt(square) - oracle::Wide(hit.normal[axis]);
    off += difference * difference;
  }
  EXPECT_LE(sqrt(off), oracle::Wide(hit.normal_error) + 1e-20);
}

struct Counts {
  int hits = 0;
  int misses = 0;
  int by_filter = 0;
};

/// Both ways of answering, with and without the filter, against the oracle.
void cast_and_compare(const Ray& ray, const Twin& twin, const std::string& box, Counts& counts) {
  const ImplicitSurface surface = read_implicit_surface(twin.text + box);
  const Truth truth = truth_of(ray, twin, surface);
  ImplicitHit hit;
  const ExactResult verdict = cast_ray(ray, surface, hit);
  expect_true(truth, verdict, hit);
  ImplicitHit exact_hit;
  expect_true(truth, cast_ray_by_rationals(ray, surface, exact_hit), exact_hit);
  // A wide bracket is the filter's own, and not narrowed by rationals.
  ImplicitHit wide_hit;
  expect_true(truth, cast_ray(ray, surface, wide_hit, 1e-2), wide_hit);
  if (testing::Test::HasFatalFailure()) return;
  ++(verdict.yes() ? counts.hits : counts.misses);
  if (verdict.level == Level::filter) ++counts.by_filter;
  if (!verdict.yes()) return;
  expect_normal(ray, twin, truth, hit);
  EXPECT_LE(hit.high - hit.low, std::max(kBracketAsked * hit.high, std::nextafter(hit.low, kInfinity) - hit.low));
  EXPECT_LE(std::max(hit.low, exact_hit.low), std::min(hit.high, exact_hit.high));
}

int ray_count() {
  const char* asked = std::getenv("COLLIDED_IMPLICIT_RAYS");
  return asked == nullptr ? 8 : std::atoi(asked);
}

Vec3 any_point(std::mt19937_64& generator, double reach) {
  std::uniform_real_distribution<double> any(-reach, reach);
  return {any(generator), any(generator), any(generator)};
}

class ExactImplicitRay : public testing::TestWithParam<int> {};

// A20: the bracket of a ray's hit on a surface f(p) = 0 of the user's holds the root by rationals.
TEST_P(ExactImplicitRay, RandomPolynomialsAreMetAsByRationals) {
  std::mt19937_64 generator = oracle::seeded(2000 + static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> any(-1, 1);
  std::uniform_int_distribution<int> exponent(-40, 40);
  Counts counts;
  for (int i = 0; i < ray_count(); ++i) {
    const bool wild = i % 4 == 3;
    const Twin twin = random_polynomial(GetParam(), generator,
                                        [&] { return std::ldexp(any(generator), wild ? exponent(generator) : 0); });
    const double length = i % 3 == 0 ? std::abs(any(generator)) * 4 : kInfinity;
    const Ray ray{any_point(generator, 2), any_point(generator, 1), length};
    SCOPED_TRACE(twin.text);
    cast_and_compare(ray, twin, i % 5 == 0 ? " in -1 -1 -1 1 1 1" : "", counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.hits, ray_count() / 12);
  EXPECT_GT(counts.misses, 0);
  EXPECT_GT(counts.by_filter, 0);
}

INSTANTIATE_TEST_SUITE_P(Degrees, ExactImplicitRay, testing::Range(1, 9));

/// Along (1, 2, 2) / 3, whose length is whole: f is a polynomial in u = x + 2 y + 2 z with the roots given, so t = u / 9.
Twin planted(const std::vector<int>& roots) {
  Twin twin{"", 1};
  for (const int root : roots) {
    twin.text += (twin.text.empty() ? "" : "*") + std::string("(x+2*y+2*z-(") + written(root) + "))";
    twin.exact = twin.exact * (kX + kY * Trivariate(2) + kZ * Trivariate(2) - Trivariate(root));
  }
  return twin;
}

// Double, triple and eightfold roots, at the start, at the end, an ulp beyond either, behind simple ones.
TEST(ExactImplicitRayPlanted, MultipleRootsAndRootsAtTheEndsAreMet) {
  Counts counts;
  const std::vector<std::vector<int>> plans{{9},
                                            {9, 9},
                                            {9, 9, 9},
                                            {0},
                                            {0, 0},
                                            {0, 0, 9},
                                            {-9, 0, 9},
                                            {18, 18, 18, 18, 18, 18, 18, 18},
                                            {9, 18, 18, 27},
                                            {9, 9, 10, 10},
                                            {-9, -9},
                                            {27, 18, 9, 9, 18, 27},
                                            {1, 2, 3, 4, 5, 6, 7, 8}};
  for (const std::vector<int>& roots : plans) {
    for (const double length : {0.0, 3.0, std::nextafter(3.0, 0.0), std::nextafter(3.0, 4.0), 6.0, kInfinity}) {
      for (const double start : {0.0, 1.0, 0x1p-60, -0x1p-60}) {
        const Ray ray{{start, 0, 0}, {1, 2, 2}, length};
        SCOPED_TRACE(testing::Message() << planted(roots).text << " length " << length << " start " << start);
        cast_and_compare(ray, planted(roots), "", counts);
        // The box's faces count: its corner is where the ray is at t = 1.
        cast_and_compare(ray, planted(roots), " in 1 2 2 9 9 9", counts);
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(counts.hits, 100);
  EXPECT_GT(counts.misses, 100);
}

TEST(ExactImplicitRayPlanted, TheBoxAndTheLengthSayWhichRootIsFirst) {
  const Twin twin = planted({9, 18, 27});
  const auto first = [&](const char* box, double start_x, double length) {
    ImplicitHit hit;
    const Ray ray{{start_x, 0, 0}, {1, 2, 2}, length};
    const bool met = cast_ray(ray, read_implicit_surface(twin.text + box), hit).yes();
    if (!met) return -1.0;
    EXPECT_LE(hit.low, std::round(hit.low + 1e-9));
    EXPECT_GE(hit.high, std::round(hit.low + 1e-9));
    return std::round(hit.low + 1e-9);
  };
  EXPECT_EQ(first("", 0, kInfinity), 1);
  EXPECT_EQ(first(" in 1 2 2 9 9 9", 0, kInfinity), 1);
  EXPECT_EQ(first(" in 1.0000000000000002 0 0 9 9 9", 0, kInfinity), 2);
  EXPECT_EQ(first(" in 0 0 0 2 4 4", 0, kInfinity), 1);
  EXPECT_EQ(first(" in 1.5 0 0 1.9 9 9", 0, kInfinity), -1);
  EXPECT_EQ(first(" in 2.5 0 0 3 6 6", 0, 9), 3);
  EXPECT_EQ(first(" in 2.5 0 0 3 6 6", 0, std::nextafter(9.0, 0.0)), -1);
}

// A ray past a sphere at exactly its radius touches it; an ulp farther out it does not, an ulp nearer it cuts.
TEST(ExactImplicitRayPlanted, TangentRaysTouchAndAnUlpDecides) {
  Counts counts;
  for (const double far : {0.0, 1.0, 0x1p30, 1e8}) {
    for (const double radius : {1.0, 3.0, 0x1p-30}) {
      const Vec3 center(far, -far, far);
      const Twin twin = sphere(center, radius);
      const ImplicitSurface surface = read_implicit_surface(twin.text);
      for (const int step : {-1, 0, 1}) {
        const double exactly = center.y() + radius;
        const double y = step == 0 ? exactly : std::nextafter(exactly, step * kInfinity);
        const Ray ray{{center.x() - 5, y, center.z()}, {1, 0, 0}};
        cast_and_compare(ray, twin, "", counts);
        ImplicitHit hit;
        const ExactResult verdict = cast_ray(ray, surface, hit);
        if (exactly - center.y() == radius) {
          EXPECT_EQ(verdict.yes(), step <= 0) << far << " " << radius << " " << step;
        }
        if (step == 0 && verdict.yes() && exactly - center.y() == radius) {
          EXPECT_EQ(hit.low, 5);
          EXPECT_EQ(hit.high, 5);
          EXPECT_EQ(hit.normal, Vec3(0, 1, 0));
        }
      }
    }
  }
}

// Ever nearer to tangent, from near and far: two roots that run into each other, where a bracket is easily too narrow.
TEST(ExactImplicitRayPlanted, GrazingRaysHoldTheirBrackets) {
  std::mt19937_64 generator = oracle::seeded(41);
  std::uniform_real_distribution<double> any(0.5, 1);
  Counts counts;
  for (int exponent = 4; exponent < 56; ++exponent) {
    const double depth = std::ldexp(any(generator), -exponent);
    const Vec3 aside = any_point(generator, 1);
    const Vec3 across = Vec3(0, 1, 0).cross(aside).normalized();
    const Vec3 top(0.1, 1 - depth, -0.2);
    const double displacement = exponent % 2 == 0 ? 3 : 1e7;
    const Vec3 origin = Vec3(top.x(), 0, top.z()) - displacement * across + top.y() * Vec3(0, 1, 0);
    cast_and_compare({origin, across}, sphere({0.1, 0, -0.2}, 1), "", counts);
    cast_and_compare({{-displacement, 3 - depth, 0.25 * depth}, {1, 0, 0}}, torus(),
                     exponent % 3 == 0 ? " in -1 2 -1 1 4 1" : "", counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.hits, 50);
}

TEST(ExactImplicitRayPlanted, FarOriginsAndWildCoefficientsKeepTheirAnswers) {
  std::mt19937_64 generator = oracle::seeded(77);
  std::uniform_real_distribution<double> any(-1, 1);
  Counts counts;
  for (int i = 0; i < ray_count(); ++i) {
    const double far = i % 2 == 0 ? 1e8 : 1e15;
    const Vec3 aim = any_point(generator, 3.2);
    const Vec3 origin = far * any_point(generator, 1);
    cast_and_compare({origin, aim - origin}, torus(), i % 4 < 2 ? "" : " in -3 -3 -1 3 3 1", counts);
    const Vec3 center = far * any_point(generator, 1);
    cast_and_compare({center + any_point(generator, 3), any_point(generator, 1)}, sphere(center, 2), "", counts);
    const double scale = i % 2 == 0 ? 0x1p400 : 0x1p-400;
    const Vec3 moved = scale * any_point(generator, 2);
    cast_and_compare({moved, any_point(generator, 1)}, sphere(Vec3::Zero(), scale), "", counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.hits, ray_count() / 2);
  EXPECT_GT(counts.misses, ray_count() / 4);
}

// Exponents at the ends of double, where squares leave it on both sides.
TEST(ExactImplicitRayPlanted, NumbersAtTheEndsOfDoubleAreDecided) {
  Counts counts;
  cast_and_compare({{0, 0, 0}, {1, 0, 0}}, {"1e-300*x-1e300", kX * Trivariate(1e-300) - 1e300}, "", counts);
  cast_and_compare({{0, 0, 0}, {1, 0, 0}}, {"1e300*x-1e-300", kX * Trivariate(1e300) - 1e-300}, "", counts);
  cast_and_compare({{0, 0, 0}, {5e-324, 0, 0}}, {"x-1e-300", kX - 1e-300}, "", counts);
  cast_and_compare({{1e300, 0, 0}, {-1, 0, 0}}, {"x^2-1", power(kX, 2) - 1}, "", counts);
  cast_and_compare({{-1e200, 1e-200, 0}, {1e200, 0, 0}}, {"x^2+y^2-5e-324", power(kX, 2) + power(kY, 2) - 5e-324}, "",
                   counts);
  cast_and_compare({{-1, 0, 0}, {1, 0, 0}}, {"x^2+1e-320", power(kX, 2) + 1e-320}, "", counts);
  EXPECT_EQ(counts.hits, 5);
  EXPECT_EQ(counts.misses, 1);
}

TEST(ExactImplicitRayPlanted, ARayWithinTheSurfaceIsMetWhereItComesIn) {
  Counts counts;
  const Twin plane{"z*(x^2+y^2+1)", kZ * (kX * kX + kY * kY + 1)};
  cast_and_compare({{-5, 0, 0}, {1, 0, 0}}, plane, "", counts);
  cast_and_compare({{-5, 0, 0}, {3, 0, 0}}, plane, " in -1 -1 -1 1 1 1", counts);
  cast_and_compare({{-5, 0.5, 0}, {3, 0.125, 0}, 100}, plane, " in -1 -1 -1 1 1 1", counts);
  cast_and_compare({{-5, 0, 0}, {1, 0, 0}, 3.5}, plane, " in -1 -1 -1 1 1 1", counts);
  cast_and_compare({{-5, 0, 0}, {-1, 0, 0}}, plane, " in -1 -1 -1 1 1 1", counts);
  EXPECT_EQ(counts.hits, 3);
  EXPECT_EQ(counts.misses, 2);
}

TEST(ExactImplicitRayPlanted, ApexesCreasesAndSquaresHaveNoNormal) {
  const auto normal_of = [](const char* text, const Ray& ray) {
    ImplicitHit hit;
    EXPECT_TRUE(cast_ray(ray, read_implicit_surface(text), hit).yes()) << text;
    return hit.normal_state;
  };
  using Normal = ImplicitHit::Normal;
  EXPECT_EQ(normal_of("x^2+y^2-z^2", {{0, 0, 0}, {1, 0, 0}}), Normal::singular);
  EXPECT_EQ(normal_of("x^2+y^2-z^2", {{-2, 0, 0}, {1, 0, 0}}), Normal::singular);
  EXPECT_EQ(normal_of("x^2+y^2-z^2", {{-2, 0, 1}, {1, 0, 0}}), Normal::known);
  EXPECT_EQ(normal_of("(x^2+y^2+z^2-2)^2", {{0, 0, -3}, {0, 0, 1}}), Normal::singular);
  EXPECT_EQ(normal_of("x*y", {{-1, -1, 0}, {1, 1, 0}}), Normal::singular);
  EXPECT_EQ(normal_of("x*y", {{-1, -0.99999999999999989, 0}, {1, 1, 0}}), Normal::known);
}

TEST(ExactImplicitRayPlanted, TheSphereIsTheEnginesSphere) {
  std::mt19937_64 generator = oracle::seeded(31);
  int hits = 0;
  for (int i = 0; i < 20 * ray_count(); ++i) {
    const Vec3 center = any_point(generator, 3);
    const double radius = 0.1 + std::abs(any_point(generator, 2).x());
    const Vec3 origin = any_point(generator, 6);
    const Ray ray{origin, center + 1.5 * radius * any_point(generator, 1) - origin, i % 2 == 0 ? kInfinity : 4};
    RayHit solid;
    ImplicitHit hit;
    const bool met = cast_ray(ray, Sphere{center, radius}, solid).yes();
    const bool surface_met = cast_ray(ray, read_implicit_surface(sphere(center, radius).text), hit).yes();
    if (met && solid.inside && solid.exit_m > 3.999 && solid.exit_m < 4.001) continue;
    ASSERT_EQ(surface_met, met && (!solid.inside || solid.exit_m <= ray.length_m));
    if (!surface_met) continue;
    ++hits;
    const double distance = solid.inside ? solid.exit_m : solid.distance_m;
    const double error = solid.inside ? solid.exit_error_m : solid.distance_error_m;
    EXPECT_LE(std::abs(hit.distance_m - distance), hit.distance_error_m + error);
    EXPECT_LE((hit.normal - solid.normal).norm(), hit.normal_error + 1e-9);
  }
  EXPECT_GT(hits, 2 * ray_count());
}

TEST(ExactImplicitRayPlanted, InsideOnAndOutsideAreToldApart) {
  std::mt19937_64 generator = oracle::seeded(5);
  const auto side = [](const ImplicitSurface& surface, const Vec3& point) {
    Side told = Side::on;
    EXPECT_TRUE(side_of(point, surface, told).yes());
    return told;
  };
  std::array<int, 3> seen{};
  const Twin ring = torus();
  const ImplicitSurface surface = read_implicit_surface(ring.text);
  // Whole points of the torus, and each neighbour by an ulp.
  const double up = std::nextafter(3.0, 4.0), down = std::nextafter(3.0, 0.0);
  EXPECT_EQ(side(surface, {3, 0, 0}), Side::on);
  EXPECT_EQ(side(surface, {0, -1, 0}), Side::on);
  EXPECT_EQ(side(surface, {0, 2, 1}), Side::on);
  EXPECT_EQ(side(surface, {up, 0, 0}), Side::outside);
  EXPECT_EQ(side(surface, {down, 0, 0}), Side::inside);
  EXPECT_EQ(side(surface, {3, 1e-300, 0}), Side::outside);
  for (int i = 0; i < 50 * ray_count(); ++i) {
    const Vec3 displacement = any_point(generator, 1).normalized();
    // Rounded onto the tube: within an ulp or so, where the double that is nearest does not say which side.
    const Vec3 middle = 2 * Vec3(displacement.x(), displacement.y(), 0).normalized();
    const Vec3 point = i % 4 == 0 ? any_point(generator, 3) : Vec3(middle + displacement);
    const Rational f = ring.exact.at(oracle::exact(point));
    const Side expected = f < 0 ? Side::inside : f > 0 ? Side::outside : Side::on;
    ASSERT_EQ(side(surface, point), expected) << point.transpose();
    ++seen[static_cast<std::size_t>(static_cast<int>(expected) + 1)];
  }
  EXPECT_GT(seen[0], 5 * ray_count());
  EXPECT_GT(seen[2], 5 * ray_count());
  const ImplicitSurface half = read_implicit_surface(ring.text + " in 0 -3 -1 3 3 1");
  EXPECT_EQ(side(half, {2, 0, 0}), Side::inside);
  EXPECT_EQ(side(half, {-2, 0, 0}), Side::outside);
}

TEST(ExactImplicitRayPlanted, WithoutRationalsWhatIsOpenIsUndecided) {
  const PrecisionScope doubles({.highest = Level::filter, .error_asked_m = 0});
  ImplicitHit hit;
  const ImplicitSurface ball = read_implicit_surface("x^2+y^2+z^2-1");
  EXPECT_EQ(cast_ray({{-5, 1, 0}, {1, 0, 0}}, ball, hit).decision, Decision::undecided);
  EXPECT_EQ(cast_ray({{-5, 0.5, 0}, {1, 0, 0}}, ball, hit).decision, Decision::yes);
  EXPECT_EQ(cast_ray({{-5, 1.5, 0}, {1, 0, 0}}, ball, hit).decision, Decision::no);
}

}  // namespace
}  // namespace collided::engine::implicit_ray_test
