#include <algorithm>
#include <cmath>
#include <random>

#include "server/geometry/tolerance.hpp"
#include "server/world/objects/swept_object.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Wide;

/// A box that flies past a resting ball and turns by up to half a turn.
struct Flight {
  ObjectInfo box;
  ObjectInfo ball;
  Pose from;
  Pose to;
};

/// How far the ball's surface is from the box at time t; below 0 within the ball's radius. In the number type T.
template <class T>
class Gap {
 public:
  explicit Gap(const Flight& flight)
      : half_(std::get<Box>(flight.box.primitives[0]).half_m),
        center_(std::get<Sphere>(flight.ball.primitives[0]).center),
        radius_(static_cast<T>(std::get<Sphere>(flight.ball.primitives[0]).radius_m)),
        start_(flight.from.position),
        travel_(V<T>(flight.to.position) - V<T>(flight.from.position)),
        first_(unit(flight.from.rotation)),
        axis_(0, 0, 0) {
    using std::atan2;
    using std::sqrt;
    const Turn last = unit(flight.to.rotation);
    // last times the inverse of first, through the smaller angle
    T w = last.w * first_.w + last.v.dot(first_.v);
    V<T> v = last.v * first_.w - first_.v * last.w - last.v.cross(first_.v);
    if (w < 0) w = -w, v = v * T(-1);
    const T sine = sqrt(v.dot(v));
    angle_ = 2 * atan2(sine, w);
    if (sine > 0) axis_ = v * T(1 / sine);
  }

  T operator()(const T& t) const {
    using std::abs;
    using std::cos;
    using std::sin;
    using std::sqrt;
    const V<T> away = center_ - (start_ + travel_ * t);
    const T half_angle = angle_ * t / 2;
    const V<T> before = turned_back(away, {T(cos(half_angle)), axis_ * T(sin(half_angle))});
    const V<T> local = turned_back(before, first_);
    const auto beyond = [](const T& x, double half) { return std::max(T(abs(x) - T(half)), T(0)); };
    const V<T> out(beyond(local.x, half_[0]), beyond(local.y, half_[1]), beyond(local.z, half_[2]));
    return T(sqrt(out.dot(out)) - radius_);
  }

 private:
  struct Turn {
    T w;
    V<T> v;
  };
  static Turn unit(const Quat& q) {
    using std::sqrt;
    const V<T> v(T(q.x()), T(q.y()), T(q.z()));
    const T w(q.w());
    const T scale = 1 / sqrt(T(w * w + v.dot(v)));
    return {T(w * scale), v * scale};
  }
  /// The vector turned by the inverse of a unit quaternion.
  static V<T> turned_back(const V<T>& p, const Turn& by) {
    const V<T> u = p.cross(by.v) * T(2);
    return p + u * by.w + u.cross(by.v);
  }

  Vec3 half_;
  V<T> center_;
  T radius_;
  V<T> start_;
  V<T> travel_;
  Turn first_;
  V<T> axis_;
  T angle_ = 0;
};

/// What most programs do: the poses of so many frames, one after the other.
Answer sampled(const Flight& flight, int frames) {
  const Gap<double> gap(flight);
  for (int i = 0; i <= frames; ++i) {
    const double t = static_cast<double>(i) / frames;
    if (gap(t) <= 0) return {true, t};
  }
  return {};
}

/// The first crossing: between two of many samples, then by bisection in a hundred digits.
Truth turning_truth(const Flight& flight) {
  constexpr int kSamples = 1 << 14;
  const Gap<double> gap(flight);
  if (gap(0) <= 0) return {true, 0};
  for (int i = 1; i <= kSamples; ++i) {
    if (gap(static_cast<double>(i) / kSamples) > 0) continue;
    const Gap<Wide> exact(flight);
    Wide low = Wide(i - 1) / kSamples;
    Wide high = Wide(i) / kSamples;
    for (int k = 0; k < 120; ++k) {
      const Wide middle = (low + high) / 2;
      (exact(middle) <= 0 ? high : low) = middle;
    }
    return {true, high};
  }
  return {};
}

/// How far the least gap of all samples is from zero. Where that is next to nothing, samples do not show whether the two
/// meet.
double least_gap_m(const Flight& flight) {
  const Gap<double> gap(flight);
  double least = gap(0);
  for (int i = 1; i <= 4096; ++i) least = std::min(least, gap(i / 4096.0));
  return std::abs(least);
}

Answer decided_turning(const Flight& flight, double width) {
  SweptContact touch;
  WalkCost cost;
  sweep(SweptBody(flight.box, BodyMotion(frame_of(flight.from), frame_of(flight.to))),
        SweptBody(flight.ball, BodyMotion::resting(Frame{})), {.width = width, .contacts = false}, cost, touch);
  if (touch.undecided) return {.undecided = true};
  if (!touch.yes) return {};
  const TimeBracket& bracket = touch.bracket;
  const double middle = bracket.low + 0.5 * (bracket.high - bracket.low);
  return {true, middle, std::max(bracket.high - middle, middle - bracket.low) + kRoundoff * middle};
}

std::vector<Flight> flights(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<Flight> result;
  while (static_cast<int>(result.size()) < count) {
    oracle::RandomShapes shapes(random, oracle::Family::random);
    Flight flight;
    const auto size = [&] { return 0.6 + 0.5 * in(random); };
    flight.box.primitives = {Box{Vec3::Zero(), Mat3::Identity(), {size(), size(), size()}}};
    flight.ball.primitives = {Sphere{Vec3::Zero(), 0.3 + 0.2 * in(random)}};
    const auto rotation = [&] { return Quat(in(random), in(random), in(random), in(random)).normalized(); };
    flight.from = {Vec3(3, in(random), in(random)), rotation()};
    flight.to = {Vec3(-3, in(random), in(random)), rotation()};
    if (least_gap_m(flight) > 1e-3) result.push_back(std::move(flight));
  }
  return result;
}

}  // namespace

std::vector<Row> study_turning(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 17);
  const std::vector<Flight> questions = flights(setting.count(400), random);
  std::vector<Truth> truth;
  for (const Flight& flight : questions) truth.push_back(turning_truth(flight));
  std::vector<Method> methods;
  for (const int frames : {10, 100, 1000, 10'000}) {
    if (setting.quick && frames > 100) continue;
    methods.push_back({"sampled, plain double", std::to_string(frames) + " frames", static_cast<double>(frames),
                       each(questions, [frames](const Flight& flight) { return sampled(flight, frames); })});
  }
  for (const double width : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
    if (setting.quick && width != 1e-2 && width != 1e-8) continue;
    methods.push_back({"ours: width asked", "width " + short_number(width, 1), width,
                       each(questions, [width](const Flight& flight) { return decided_turning(flight, width); })});
  }
  // Absolute, in pieces: an extent of 2^53 makes the least divisor 1.
  return measure("turning", "boxes that fly past a ball and turn by up to half a turn", methods, truth, 0x1p53,
                 setting.repeats());
}

}  // namespace collided::report
