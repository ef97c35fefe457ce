// What is told of a posed shape holds for the shape and the pose that were given: placing rounds, and the bounds have it.
#include <gtest/gtest.h>

#include <random>

#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::placing_test {
namespace {

using oracle::Wide;
using WidePoint = std::array<Wide, 3>;

WidePoint wide(const Vec3& v) { return {Wide(v[0]), Wide(v[1]), Wide(v[2])}; }
Wide dot(const WidePoint& a, const WidePoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
WidePoint minus(const WidePoint& a, const WidePoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide at_least_0(const Wide& x) { return x > 0 ? x : Wide(0); }

/// A pose as it was sent.
struct Sent {
  Quat q;
  Vec3 position;

  Pose pose() const { return {.position = position, .rotation = q}; }
  /// Seen from the shape's own frame: q* v q / |q|^2.
  WidePoint turned_back(const WidePoint& v) const {
    const WidePoint u{Wide(-q.x()), Wide(-q.y()), Wide(-q.z())};
    const Wide w = q.w();
    const WidePoint across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const Wide uu = dot(u, u);
    const Wide uv = dot(u, v);
    WidePoint back;
    for (std::size_t i = 0; i < 3; ++i)
      back[i] = ((w * w - uu) * v[i] + 2 * uv * u[i] + 2 * w * across[i]) / (w * w + uu);
    return back;
  }
  WidePoint seen(const Vec3& point) const { return turned_back(minus(wide(point), wide(position))); }
};

struct Kind {
  const char* name;
  Shape shape;
  Wide (*distance)(const WidePoint& p);  // from its own frame
};

const WidePoint kBallAt{Wide(1.25), Wide(-0.5), Wide(0.75)};

std::vector<Kind> kinds() {
  const Vec3 corner(1, 0.5, 0.25);
  TriangleMesh speck;
  speck.vertices = {corner, corner, corner};
  speck.triangles = {{0, 1, 2}};
  const auto solid = [](Primitive primitive) { return Shape{.primitives = {std::move(primitive)}, .mesh = nullptr}; };
  return {
      {"ball off its centre", solid(Sphere{{1.25, -0.5, 0.75}, 0.5}),
       [](const WidePoint& p) -> Wide {
         const WidePoint w = minus(p, kBallAt);
         return sqrt(dot(w, w)) - Wide(0.5);
       }},
      {"box", solid(Box{.center = Vec3::Zero(), .half_m = {0.3, 0.5, 0.7}}),
       [](const WidePoint& p) -> Wide {
         const Wide x = at_least_0(abs(p[0]) - Wide(0.3)), y = at_least_0(abs(p[1]) - Wide(0.5)),
                    z = at_least_0(abs(p[2]) - Wide(0.7));
         return sqrt(x * x + y * y + z * z);
       }},
      {"coin", solid(Cylinder{{0, 0, -0.0005}, {0, 0, 0.0005}, 1}),
       [](const WidePoint& p) -> Wide {
         const Wide z = at_least_0(abs(p[2]) - Wide(0.0005)), r = at_least_0(sqrt(p[0] * p[0] + p[1] * p[1]) - 1);
         return sqrt(z * z + r * r);
       }},
      {"capsule", solid(Capsule{{0, 0, -1}, {0, 0, 1}, 0.25}),
       [](const WidePoint& p) -> Wide {
         const Wide z = at_least_0(abs(p[2]) - 1);
         return sqrt(p[0] * p[0] + p[1] * p[1] + z * z) - Wide(0.25);
       }},
      {"corner of a mesh", extreme::mesh_shape(speck),
       [](const WidePoint& p) -> Wide {
         const WidePoint w = minus(p, {Wide(1), Wide(0.5), Wide(0.25)});
         return sqrt(dot(w, w));
       }},
  };
}

class ExtremePlacing : public testing::Test {
 protected:
  double any(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 point(double middle, double size) {
    return {middle + any(-size, size), middle + any(-size, size), middle + any(-size, size)};
  }
  Sent sent(double far_m) {
    std::normal_distribution<double> normal;
    Sent made{Quat(normal(random), normal(random), normal(random), normal(random)).normalized(), point(far_m, 1)};
    made.q.coeffs() *= 1 + any(-1e-6, 1e-6);
    return made;
  }
  std::mt19937_64 random = oracle::seeded(50);
};

TEST_F(ExtremePlacing, DistancesHoldForTheNumbersGiven) {
  int told = 0;
  for (const Kind& kind : kinds()) {
    for (const double far_m : {0.0, 1e3, 1e6, 1e9}) {
      for (int i = 0; i < 25; ++i) {
        const Sent given = sent(far_m);
        const Vec3 from = point(far_m, 6);
        const Wide truth = kind.distance(given.seen(from));
        if (truth < 1e-3) continue;
        extreme::Stage stage;
        const ObjectId a = stage.add("a", kind.shape, given.pose());
        const ObjectId b = stage.add("b", extreme::ball_shape(0), extreme::at(from));
        stage.step();
        const PairReport report = report_pair(*stage.world.newest(), a, b, {});
        ASSERT_EQ(report.touches, Decision::no);
        ASSERT_LE(abs(truth - Wide(report.separation.distance_m)), Wide(report.separation.error_m))
            << kind.name << " at " << far_m;
        const Answers near = stage.ask(QuestionKind::near, {from.x(), from.y(), from.z(), extreme::kEndless});
        ASSERT_TRUE(extreme::is_hit(near));
        for (const AnswerHit& hit : near.hits) {
          if (hit.object != a) continue;
          ASSERT_LE(abs(truth - Wide(hit.distance_m)), Wide(hit.error_m)) << kind.name << " at " << far_m;
          ++told;
        }
      }
    }
  }
  EXPECT_GT(told, 300);
}

TEST_F(ExtremePlacing, RaysHoldForTheNumbersGiven) {
  int met = 0;
  for (const double far_m : {0.0, 1e3, 1e6, 1e9}) {
    for (int i = 0; i < 100; ++i) {
      const Sent given = sent(far_m);
      extreme::Stage stage;
      stage.add("a", kinds()[0].shape, given.pose());
      stage.step();
      const Vec3 from = point(far_m, 6);
      // About to the ball's middle, and somewhat beside it.
      const Vec3 middle = place(frame_of(given.pose()), Vec3(1.25, -0.5, 0.75));
      const Vec3 displacement = middle - from + point(0, 0.2);
      const Answers answers = stage.ray(from, displacement);
      const WidePoint w = minus(given.seen(from), kBallAt);
      const WidePoint d = given.turned_back(wide(displacement));
      const Wide length2 = dot(d, d);
      const Wide b = dot(w, d);
      const Wide room = b * b - length2 * (dot(w, w) - Wide(0.25));
      if (room <= 0 || dot(w, w) <= Wide(0.26) || !extreme::is_hit(answers)) continue;
      const Wide truth = (-b - sqrt(room)) / sqrt(length2);
      const AnswerHit& hit = answers.hits.front();
      ASSERT_LE(abs(truth - Wide(hit.distance_m)), Wide(hit.error_m)) << far_m << " " << i;
      ++met;
      if (std::isfinite(hit.error_m)) continue;
      ASSERT_LT(room, Wide(1e-3) * length2) << "only where the ray grazes";
    }
  }
  EXPECT_GT(met, 250);
}

/// How deep a ball question's ball is in a posed ball.
TEST_F(ExtremePlacing, DepthsHoldForTheNumbersGiven) {
  for (const double far_m : {0.0, 1e3, 1e6, 1e9}) {
    for (int i = 0; i < 60; ++i) {
      const Sent given = sent(far_m);
      extreme::Stage stage;
      const ObjectId a = stage.add("a", kinds()[0].shape, given.pose());
      const Vec3 middle = place(frame_of(given.pose()), Vec3(1.25, -0.5, 0.75)) + point(0, 0.3);
      const ObjectId b = stage.add("b", extreme::ball_shape(0.5), extreme::at(middle));
      const std::vector<Event>& events = stage.step();
      const Wide truth = Wide(0.5) - kinds()[0].distance(given.seen(middle));
      const Answers answers = stage.ask(QuestionKind::sphere, {middle.x(), middle.y(), middle.z(), 0.5});
      for (const AnswerHit& hit : answers.hits) {
        if (hit.object != a) continue;
        ASSERT_LE(abs(truth - Wide(hit.distance_m)), Wide(hit.error_m)) << far_m;
      }
      const PairReport report = report_pair(*stage.world.newest(), a, b, {});
      ASSERT_LE(abs(truth - Wide(report.contact.depth_m)), Wide(report.contact.depth_error_m)) << far_m;
      ASSERT_EQ(events.size(), 1u);
      ASSERT_LE(abs(truth - Wide(events[0].of.contact.depth_m)), Wide(events[0].of.contact.depth_error_m)) << far_m;
    }
  }
}

}  // namespace
}  // namespace collided::engine::placing_test
