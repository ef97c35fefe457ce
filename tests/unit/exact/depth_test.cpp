#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <variant>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

// A depth is carried out: moved apart by it, a pair parts; moved by less, in whatever direction, it does not.  // A44
namespace collided::engine::depth_test {
namespace {

using oracle::Family;
using oracle::RandomShapes;

/// A primitive or a triangle.
using Any = std::variant<Primitive, Triangle>;

constexpr int kPrimitives = std::variant_size_v<Primitive>;
constexpr const char* kNames[] = {"sphere",    "box",  "capsule",    "cylinder", "cone",
                                  "ellipsoid", "hull", "half-space", "triangle"};

Any made(RandomShapes& make, int kind) {
  switch (kind) {
    case 0: return Primitive(make.sphere());
    case 1: return Primitive(make.box());
    case 2: return Primitive(make.capsule());
    case 3: return Primitive(make.cylinder());
    case 4: return Primitive(make.cone());
    case 5: return Primitive(make.ellipsoid());
    case 6: return Primitive(make.hull());
    case 7: {
      HalfSpace h{make.point(), make.point() - make.point()};
      while (h.normal.isZero(0)) h.normal = make.point() - make.point();
      return Primitive(h);
    }
    default: return make.triangle();
  }
}

ExactResult overlap_of(const Primitive& a, const Any& b) {
  return std::visit([&](const auto& other) { return overlaps(a, other); }, b);
}
Contact contact_of(const Primitive& a, const Any& b) {
  return std::visit([&](const auto& other) { return contact(a, other); }, b);
}
Any moved(const Any& shape, const Vec3& by) {
  return std::visit([&](const auto& own) { return Any(place(Frame{Mat3::Identity(), by}, own)); }, shape);
}

/// What moving may turn a short axis by, times the radius across it: its ends, a few metres from the origin, are rounded
/// each by itself.
double turning_m(const Primitive& shape) {
  constexpr double kRounding_m = 4 * 0x1p-51;
  const auto turned = [](const Vec3& axis, double radius_m) { return kRounding_m * radius_m / axis.norm(); };
  if (const auto* c = std::get_if<Cylinder>(&shape)) return turned(c->b - c->a, c->radius_m);
  if (const auto* c = std::get_if<Cone>(&shape)) return turned(c->base - c->apex, c->radius_m);
  return 0;
}
double turning_m(const Any& shape) {
  const auto* primitive = std::get_if<Primitive>(&shape);
  return primitive == nullptr ? 0 : turning_m(*primitive);
}

class ExactDepth : public ::testing::TestWithParam<Family> {};

TEST_P(ExactDepth, PartsThePairAndNothingShorterDoes) {
  std::mt19937_64 random = oracle::seeded(51);
  RandomShapes make(random, GetParam());
  std::normal_distribution<double> component;
  const char* asked = std::getenv("COLLIDED_DEPTHS");
  const long rounds = asked != nullptr ? std::atol(asked) : 40;
  // Of coordinates of a few metres: the roundings of moving and of the normal.
  constexpr double kSlack = 1e-11;
  long checked = 0;
  for (long round = 0; round < rounds; ++round) {
    for (int i = 0; i < kPrimitives; ++i) {
      for (int k = 0; k <= kPrimitives; ++k) {
        if (i == 7 && k == 7) continue;  // half-spaces do not part
        const Primitive a = std::get<Primitive>(made(make, i));
        const Any b = made(make, k);
        if (!overlap_of(a, b).yes()) continue;
        const Contact found = contact_of(a, b);
        SCOPED_TRACE(std::string(kNames[i]) + " " + kNames[k] + ", depth " + std::to_string(found.depth_m));
        const double slack_m = kSlack + turning_m(b);
        const double most = found.depth_m + found.depth_error_m + slack_m;
        ASSERT_NE(overlap_of(a, moved(b, most * found.normal)).decision, Decision::yes);
        const double less = found.depth_m - found.depth_error_m - slack_m;
        if (!(less > 0)) continue;
        ++checked;
        ASSERT_NE(overlap_of(a, moved(b, less * found.normal)).decision, Decision::no);
        for (int direction = 0; direction < 8; ++direction) {
          const Vec3 along = Vec3(component(random), component(random), component(random)).normalized();
          ASSERT_NE(overlap_of(a, moved(b, less * (1 - 1e-15) * along)).decision, Decision::no) << along.transpose();
        }
      }
    }
  }
  EXPECT_GT(checked, 30 * rounds) << "of 71 pairs of kinds";
}

INSTANTIATE_TEST_SUITE_P(Families, ExactDepth,
                         ::testing::Values(Family::random, Family::lattice, Family::tenths, Family::needles),
                         [](const auto& family) { return std::string(oracle::name(family.param)); });

}  // namespace
}  // namespace collided::engine::depth_test
