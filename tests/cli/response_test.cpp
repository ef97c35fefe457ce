#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/publish/bounce.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

using response::ResponseLaw;

/// Steps a run as a server would see it, which reports a pair at the first step that finds it touching.
class SeenByServer {
 public:
  explicit SeenByServer(const BounceOptions& options) : bounce_(options) {}

  void run(int steps, double seconds) {
    frame_s_ = seconds;
    for (int step = 0; step < steps; ++step) {
      report();
      bounce_.step(seconds);
    }
  }
  const Bounce& bounce() const { return bounce_; }
  double largest_speed() const {
    double largest = 0;
    for (const Sphere& sphere : bounce_.spheres()) largest = std::max(largest, sphere.velocity.norm());
    return largest;
  }

 private:
  void report() {
    const auto& spheres = bounce_.spheres();
    for (std::size_t a = 0; a < spheres.size(); ++a) {
      for (std::size_t b = a + 1; b < spheres.size(); ++b) {
        const bool touch =
            (spheres[a].position - spheres[b].position).norm() <= spheres[a].radius_m + spheres[b].radius_m;
        // Some time in the frame before: the depth says when.
        const double depth_m =
            spheres[a].radius_m + spheres[b].radius_m - (spheres[a].position - spheres[b].position).norm();
        if (touch && open_.emplace(a, b).second)
          bounce_.contact_began(a, b, {.earliest_s = frame_s_, .depth_m = depth_m});
        if (!touch && open_.erase({a, b}) > 0) bounce_.contact_ended(a, b);
      }
    }
  }

  Bounce bounce_;
  double frame_s_ = 0;
  std::set<std::pair<std::size_t, std::size_t>> open_;
};

BounceOptions crowd(ResponseLaw answer) {
  BounceOptions options{.sphere_count = 20, .relative_size = 0.2, .speed_m_s = 0.5, .seed = 7};
  options.answer = answer;
  return options;
}

TEST(PublishResponse, ElasticImpulsesKeepTheEnergyOverThousandsOfContacts) {
  SeenByServer run(crowd(ResponseLaw::impulse));
  run.run(20'000, 1.0 / 60);
  const BounceLedger ledger = run.bounce().ledger();
  EXPECT_GT(ledger.flips, 1'000U);
  EXPECT_LT(std::abs(ledger.energy_drift()), 1e-15 * static_cast<double>(ledger.flips));
}

TEST(PublishResponse, ImpulsesWithALossBringEverythingToRest) {
  BounceOptions options = crowd(ResponseLaw::impulse);
  options.restitution = 0.5;
  SeenByServer run(options);
  const double start = run.largest_speed();
  run.run(20'000, 1.0 / 60);
  EXPECT_LT(run.bounce().ledger().energy_drift(), -0.9);
  EXPECT_LT(run.largest_speed(), start);
}

// Ten orders of stiffness at one frame rate. No spring is pressed deeper than all of the energy would press it, which is a
// factor of a few over one fast contact, and no speed grows out of nothing.
TEST(PublishResponse, SpringsOfEveryStiffnessKeepTheEnergyOfACrowd) {
  for (const double stiffness : {1e2, 1e4, 1e6, 1e9, 1e12}) {
    BounceOptions options = crowd(ResponseLaw::compliant);
    options.stiffness_n_m = stiffness;
    SeenByServer run(options);
    run.run(1'000, 1.0 / 60);
    const BounceLedger ledger = run.bounce().ledger();
    EXPECT_GT(ledger.flips, 50U) << stiffness;
    EXPECT_LT(std::abs(ledger.energy_drift()), 1e-12) << stiffness;
    const double most_m = std::sqrt(2 * ledger.energy_before / stiffness);
    EXPECT_LT(ledger.penetration_m, most_m) << stiffness;
    EXPECT_GT(ledger.penetration_m, most_m / 10) << stiffness;
  }
}

TEST(PublishResponse, ALossyDamperOnlyTakesEnergy) {
  BounceOptions options = crowd(ResponseLaw::compliant);
  options.restitution = 0.5;
  SeenByServer run(options);
  run.run(1'000, 1.0 / 60);
  EXPECT_LT(run.bounce().ledger().energy_drift(), -0.5);
}

// Two spheres, no walls near: momentum stays, and of an impulse what the line of centres does not see. A spring's contact takes
// a millisecond, in which that line turns: there it is the spin about the centre of mass that stays.
TEST(PublishResponse, ImpulsesAndSpringsKeepMomentum) {
  for (const ResponseLaw answer : {ResponseLaw::impulse, ResponseLaw::compliant}) {
    response::SphereOptions options;
    options.answer = answer;
    options.half_side_m = 100;
    response::Sphere left;
    response::Sphere right;
    left.radius_m = 1;
    right.radius_m = 0.5;
    left.position = {-0.9, 0, 0};
    right.position = {0.5, 0.4, 0};
    left.velocity = {1, 0, 0.25};
    right.velocity = {-2, 0, 0};
    left.spin = right.spin = response::Vec3::Zero();
    response::Spheres spheres(options, {left, right});
    const auto spin = [&] {
      const Sphere& a = spheres.spheres()[0];
      const Sphere& b = spheres.spheres()[1];
      return (b.position - a.position).cross(b.velocity - a.velocity).eval();
    };
    const response::Vec3 spin_before = spin();
    spheres.contact_began(0, 1);
    for (int step = 0; step < 10; ++step) spheres.step(0.01);
    const response::SphereLedger ledger = spheres.ledger();
    EXPECT_NEAR((ledger.momentum_after - ledger.momentum_before).norm(), 0, 1e-15);
    EXPECT_LT(std::abs(ledger.energy_drift()), 1e-7);
    if (answer == ResponseLaw::impulse) {
      EXPECT_EQ(spheres.spheres()[0].velocity.z(), 0.25);
    } else {
      EXPECT_NEAR((spin() - spin_before).norm(), 0, 1e-14);
    }
    EXPECT_LT(spheres.spheres()[0].velocity.x(), 0.9);
  }
}

TEST(PublishResponse, AnOptionWithoutItsMeaningIsRefused) {
  for (const std::string wrong :
       {"--bounce --response bouncy", "--response impulse", "--as-asked --response impulse",
        "--bounce --restitution 0.5", "--bounce --response impulse --stiffness 1e6",
        "--bounce --response compliant --stiffness 10", "--bounce --response impulse --restitution 1.5",
        "--bounce --response compliant --restitution 0"}) {
    fake::reset();
    const Ran ran = collide("publish --spheres 2 --round --steps 1 " + wrong);
    EXPECT_EQ(ran.code, 2) << wrong << ran.out;
    EXPECT_NE(ran.err, "") << wrong;
  }
}

TEST(PublishResponse, TheSummaryTellsDriftAndPenetration) {
  fake::reset();
  const std::string options =
      "publish --spheres 2 --round --steps 3 --rate 1000 --bounce --response compliant --stiffness 1e9 ";
  const Ran plain = at_terminal(options);
  EXPECT_NE(plain.out.find("response compliant: energy drift 0, worst penetration 0 m"), std::string::npos)
      << plain.out;
  fake::reset();
  const nlohmann::json result = nlohmann::json::parse(collide(options + "--json").out);
  EXPECT_EQ(result["response"], "compliant");
  EXPECT_EQ(result["energy_drift"], 0);
  EXPECT_EQ(result["penetration_m"], 0);
  EXPECT_NE(collide("help publish").out.find("--response"), std::string::npos);
}

}  // namespace
}  // namespace collided::cli
