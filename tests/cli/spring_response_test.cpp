// Springs between spheres that a server tells of: from 1e2 to 1e12 N/m, at any frame rate, however late it is heard.
#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "client/cli/publish/bounce.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

using response::ResponseLaw;
using response::Touch;
using response::Vec3;

struct Hearing {
  double rate_hz = 60;
  int late_frames = 0;      // an event is heard so many frames after the one that it is about
  double bracket_s = 1e-6;  // its width
};

/// Two spheres as a publisher moves them and a server sees them: it knows of a touch from straight ways between frames.
class TwoSpheres {
 public:
  TwoSpheres(double stiffness, const Vec3& offset_m, const Hearing& hearing, double restitution = 1)
      : hearing_(hearing), stiffness_(stiffness) {
    response::SphereOptions options{
        .answer = ResponseLaw::compliant, .half_side_m = 100, .restitution = restitution, .stiffness_n_m = stiffness};
    response::Sphere a{.radius_m = 0.3, .position = {-0.41, 0, 0}, .velocity = {0.7, 0.1, 0}, .spin = Vec3::Zero()};
    response::Sphere b{
        .radius_m = 0.2, .position = Vec3(0.32, 0, 0) + offset_m, .velocity = {-0.5, 0.1, 0}, .spin = Vec3::Zero()};
    spheres_ = response::Spheres(options, {a, b});
    reduced_kg_ = 1 / (1 / mass(a) + 1 / mass(b));
    const Vec3 place = b.position - a.position, velocity = b.velocity - a.velocity;
    const double length = a.radius_m + b.radius_m, closing = -place.dot(velocity), speed2 = velocity.squaredNorm();
    touch_s_ = (closing - std::sqrt(closing * closing - speed2 * (place.squaredNorm() - length * length))) / speed2;
    const Vec3 touch = place + touch_s_ * velocity;
    approach_m_s_ = -velocity.dot(touch) / length;
  }

  void run(double seconds) {
    const int frames = static_cast<int>(std::round(seconds * hearing_.rate_hz));
    for (int frame = 0; frame < frames; ++frame) {
      hear(frame_++);
      spheres_.step(1 / hearing_.rate_hz);
    }
  }
  /// Of a spring that fills the real overlap, joule; true once the contact is known.
  double energy() const {
    const double depth = std::max(0.0, 0.5 - place().norm());
    const response::Sphere& a = spheres_.spheres()[0];
    const response::Sphere& b = spheres_.spheres()[1];
    return 0.5 * (mass(a) * a.velocity.squaredNorm() + mass(b) * b.velocity.squaredNorm() + stiffness_ * depth * depth);
  }
  Vec3 place() const { return spheres_.spheres()[1].position - spheres_.spheres()[0].position; }
  Vec3 velocity() const { return spheres_.spheres()[1].velocity - spheres_.spheres()[0].velocity; }
  bool is_told() const { return is_told_; }
  /// v sqrt(m / k)
  double law_m() const { return approach_m_s_ * std::sqrt(reduced_kg_ / stiffness_); }
  double contact_s() const { return 3.14159265358979324 * std::sqrt(reduced_kg_ / stiffness_); }
  double touch_s() const { return touch_s_; }
  response::SphereLedger ledger() const { return spheres_.ledger(); }

 private:
  void hear(int frame) {
    const double now = frame / hearing_.rate_hz;
    const double seen = (frame - hearing_.late_frames) / hearing_.rate_hz;
    if (is_told_ || seen < touch_s_) return;
    is_told_ = true;
    // Until it was told, the two flew on: the depth is that of straight ways.
    const double depth = 0.5 - (place() - (now - seen) * velocity()).norm();
    const double middle = now - touch_s_;
    spheres_.contact_began(0, 1,
                           {.earliest_s = middle + 0.3 * hearing_.bracket_s,
                            .latest_s = std::max(0.0, middle - 0.7 * hearing_.bracket_s),
                            .seen_s = now - seen,
                            .depth_m = depth});
  }

  Hearing hearing_;
  double stiffness_;
  response::Spheres spheres_;
  double reduced_kg_ = 0, touch_s_ = 0, approach_m_s_ = 0;
  int frame_ = 0;
  bool is_told_ = false;
};

const Hearing kHearings[]{{60, 0}, {120, 0}, {240, 0}, {60, 1}, {240, 7}, {60, 0, 1.0 / 60}, {240, 2, 1.0 / 240}};

// Ten decades. A tenth is asked for; head-on the law is exact, and what differs is rounding.
TEST(PublishSprings, PenetrationIsSpeedTimesRootOfMassOverStiffness) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const Hearing& hearing : kHearings) {
      TwoSpheres pair(stiffness, Vec3::Zero(), hearing);
      pair.run(2);
      EXPECT_NEAR(pair.ledger().penetration_m / pair.law_m(), 1, 1e-6)
          << stiffness << ' ' << hearing.rate_hz << ' ' << hearing.late_frames;
    }
  }
}

// The line of centres turns while they touch, which eases the spring: within the tenth, at any stiffness and rate.
TEST(PublishSprings, AnObliqueTouchIsWithinATenthOfTheLaw) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const Hearing& hearing : kHearings) {
      TwoSpheres pair(stiffness, {0, 0.3, 0.1}, hearing);
      pair.run(2);
      EXPECT_NEAR(pair.ledger().penetration_m / pair.law_m(), 1, 0.1)
          << stiffness << ' ' << hearing.rate_hz << ' ' << hearing.late_frames;
    }
  }
}

// The contact begins where the two touched and not where that was heard: afterwards they are where the closed form has them.
TEST(PublishSprings, TheContactBeginsInsideTheBracketWhateverTheFrames) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const Hearing& hearing : kHearings) {
      TwoSpheres pair(stiffness, Vec3::Zero(), hearing);
      pair.run(2);
      ASSERT_TRUE(pair.is_told());
      EXPECT_NEAR(pair.place().x(), 0.5 + 1.2 * (2 - pair.touch_s() - pair.contact_s()), 1e-8)
          << stiffness << ' ' << hearing.rate_hz;
      EXPECT_NEAR(pair.velocity().x(), 1.2, 1e-8) << stiffness << ' ' << hearing.rate_hz;
    }
  }
}

// Kinetic and k d^2 / 2 of the overlap that there really is, frame by frame, not of what the spring believes.
TEST(PublishSprings, TheRealSpringKeepsItsEnergy) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const Vec3& offset_m : {Vec3(0, 0, 0), Vec3(0, 0.3, 0.1)}) {
      for (const Hearing& hearing : kHearings) {
        TwoSpheres pair(stiffness, offset_m, hearing);
        const double before = pair.energy();
        int told = 0;
        for (int frame = 0; frame < 240; ++frame) {
          pair.run(1 / hearing.rate_hz);
          if (!pair.is_told()) continue;
          ++told;
          ASSERT_NEAR(pair.energy() / before, 1, 1e-9) << stiffness << ' ' << hearing.rate_hz << ' ' << frame;
        }
        EXPECT_GT(told, 0);
      }
    }
  }
}

// What holds on a soft spring is deep in it when a server that saw only straight ways says that they have parted.
TEST(PublishSprings, ASpringThatPushesDoesSoUntilItLetsGo) {
  response::SphereOptions options{.answer = ResponseLaw::compliant, .half_side_m = 100, .stiffness_n_m = 1e2};
  const response::Sphere a{.radius_m = 0.3, .position = {-0.3, 0, 0}, .velocity = {1, 0, 0}, .spin = Vec3::Zero()};
  const response::Sphere b{.radius_m = 0.3, .position = {0.3, 0, 0}, .velocity = {-1, 0, 0}, .spin = Vec3::Zero()};
  response::Spheres spheres(options, {a, b});
  spheres.contact_began(0, 1);
  spheres.step(0.01);
  EXPECT_LT(spheres.spheres()[1].position.x(), 0.295);
  spheres.contact_ended(0, 1);
  for (int step = 0; step < 20; ++step) spheres.step(0.01);
  EXPECT_NEAR(spheres.spheres()[1].velocity.x(), 1, 1e-12);
  EXPECT_NEAR(spheres.ledger().energy_drift(), 0, 1e-12);
}

// One has been at the wall since: the other's contact with it cannot be sought on the way that it has now, back through the wall.
TEST(PublishSprings, NobodyIsPutBackBeforeWhatItHasMetSince) {
  response::SphereOptions options{.answer = ResponseLaw::compliant, .half_side_m = 0.5, .stiffness_n_m = 1e12};
  const response::Sphere a{.radius_m = 0.1, .position = {0.395, 0, 0}, .velocity = {1, 0, 0}, .spin = Vec3::Zero()};
  const response::Sphere b{.radius_m = 0.1, .position = {0.183, 0, 0}, .velocity = {3, 0, 0}, .spin = Vec3::Zero()};
  response::Spheres spheres(options, {a, b});
  const double frame_s = 1.0 / 60;
  spheres.step(frame_s);
  // Between the two frames the server has a go straight from 0.395 to 0.3883, so that it finds them touching after 3.5 ms, not 5.5.
  spheres.contact_began(0, 1, {.earliest_s = frame_s - 0.0035, .latest_s = frame_s - 0.0036, .depth_m = 0.0447});
  // They touched at 5.5 ms with b at 0.1995, and b goes back at 1 m/s since.
  EXPECT_NEAR(spheres.spheres()[1].position.x(), 0.1995 - (frame_s - 0.0055), 0.004);
  EXPECT_NEAR(spheres.spheres()[1].velocity.x(), -1, 1e-9);
  EXPECT_NEAR(spheres.ledger().energy_drift(), 0, 1e-12);
}

/// A server that has followed the two spheres' poses finds their first touch between two stamps, and says so some frames late, with
/// a clock of its own that is 1.7 ms on, and farther where it does not count by the publisher's.
class LateServer {
 public:
  LateServer(std::size_t late_frames, std::chrono::seconds off) : late_frames_(late_frames), off_(off) {}

  void hears(fake::Published& published) {
    const std::size_t newest = published.batches.size() - 1;
    if (newest == 0) return;
    if (told_at_ == 0 && distance(published, newest) <= length(published)) find(published, newest);
    if (told_at_ == newest) fake::server().events.push_back(event_);
  }
  double touch_s() const { return touch_s_; }  // after the first stamp
  std::size_t told_at() const { return told_at_; }
  static Vec3 place(const fake::Published& published, std::size_t batch) {
    return published.batches[batch].at(3).position - published.batches[batch].at(2).position;
  }
  static double length(const fake::Published& published) {
    return std::get<SphereShape>(published.objects.at(2).shape[0]).radius_m +
           std::get<SphereShape>(published.objects.at(3).shape[0]).radius_m;
  }

 private:
  static double distance(const fake::Published& published, std::size_t batch) { return place(published, batch).norm(); }

  void find(const fake::Published& published, std::size_t newest) {
    const Vec3 before = place(published, newest - 1), after = place(published, newest);
    double low = 0, high = 1;
    for (int round = 0; round < 60; ++round) {
      const double middle = (low + high) / 2;
      ((before + middle * (after - before)).norm() > length(published) ? low : high) = middle;
    }
    const std::chrono::nanoseconds from = published.stamps[newest - 1], to = published.stamps[newest];
    const double since_s = high * std::chrono::duration<double>(to - from).count();
    touch_s_ = std::chrono::duration<double>(from - published.stamps[0]).count() + since_s;
    event_.kind = EventKind::began;
    event_.a = "spheres/0";
    event_.b = "spheres/1";
    event_.world_time = to + std::chrono::microseconds(1'700);
    const double ago_s = std::chrono::duration<double>(event_.world_time - from).count() - since_s;
    event_.world_time += off_;
    event_.bracket_low_s = ago_s + 2e-9;
    event_.bracket_high_s = ago_s - 2e-9;
    event_.depth_m = length(published) - after.norm();
    told_at_ = newest + late_frames_;
  }

  std::size_t late_frames_;
  std::chrono::seconds off_;
  Event event_;
  double touch_s_ = 0;
  std::size_t told_at_ = 0;
};

/// How far the two are from where they would be had the contact been where and when it was, shortly after.
void expect_as_if_touched_then(LateServer server) {
  constexpr double kRate = 2'000, kStiffness = 1e9;
  fake::reset();
  fake::server().on_flush = [&](fake::Published& published) { server.hears(published); };
  collide(
      "publish --spheres 2 --round --size 0.4 --speed 5 --seed 11 --bounce --response compliant --stiffness 1e9 --rate "
      "2000 --steps 1000 --json");
  const fake::Published published = fake::server().publishers.at(0);
  fake::reset();  // which knows `server`
  ASSERT_GT(server.told_at(), 0U) << "the two never met: another seed";
  const std::size_t after = server.told_at() + 1;
  ASSERT_LT(after + 1, published.batches.size());
  const Vec3 place = LateServer::place(published, after);
  const Vec3 velocity = (LateServer::place(published, after + 1) - place) * kRate;
  const double reduced_kg = 1e-3;  // about: the contact takes 3 us
  const double left_s = server.touch_s() + 3.14159265358979324 * std::sqrt(reduced_kg / kStiffness);
  const Vec3 parted = place - (static_cast<double>(after) / kRate - left_s) * velocity;
  EXPECT_NEAR(parted.norm(), LateServer::length(published), 5e-5);
  EXPECT_GT(parted.dot(velocity), 0);
  EXPECT_GT(LateServer::length(published) - LateServer::place(published, server.told_at()).norm(), 1e-4)
      << "or nothing was put right";
}

// All the way: stamps, an event in world time, and poses that go on as if nothing had been late.
TEST(PublishSprings, ThePublisherFindsTheTouchInItsOwnTime) {
  expect_as_if_touched_then(LateServer(2, std::chrono::seconds(0)));
}

// Then the bracket is of another clock, and depth and velocity tell.
TEST(PublishSprings, AClockOfTheServersOwnIsNotMistakenForThePublishers) {
  expect_as_if_touched_then(LateServer(0, std::chrono::hours(3)));
}

}  // namespace
}  // namespace collided::cli
