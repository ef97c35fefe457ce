#include "tests/studies/response/event_driven.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/studies/response/stepper.hpp"

namespace collided::response {

EventDriven::EventDriven(Line line, Motion start, double restitution, double resting_speed_m_s)
    : line_(std::move(line)),
      motion_(std::move(start)),
      restitution_(restitution),
      resting_speed_m_s_(resting_speed_m_s) {
  if (restitution_ < 1 && !(resting_speed_m_s_ > 0))
    throw std::invalid_argument("restitution below 1 needs a resting speed above 0");
  if (deepest_penetration(line_, motion_) > touching_gap(line_, motion_))
    throw std::invalid_argument("rigid bodies overlap at the start");
  touching_.resize(line_.size() + 1);
}

EventDriven::Next EventDriven::next_impact() const {
  Next next{std::numeric_limits<double>::infinity(), 0, 0};
  for (std::size_t contact = resting_; contact <= line_.size(); ++contact) {
    const double above = contact == line_.size() ? 0 : body_acceleration(contact);
    const double below = contact == 0 ? 0 : body_acceleration(contact - 1);
    const double open_m = gap(line_, motion_.position_m, contact);
    const double rate = gap_rate(line_, motion_.velocity_m_s, contact);
    const double seconds = time_to_touch(open_m, rate, above - below);
    if (seconds < next.seconds)
      next = {seconds, contact, std::sqrt(rate * rate - 2 * (above - below) * std::max(open_m, 0.0))};
  }
  return next;
}

void EventDriven::move(double seconds) {
  for (std::size_t body = resting_; body < line_.size(); ++body) {
    motion_.position_m[body] += (motion_.velocity_m_s[body] + 0.5 * line_.gravity_m_s2 * seconds) * seconds;
    motion_.velocity_m_s[body] += line_.gravity_m_s2 * seconds;
  }
  // source: Kahan, "Further remarks on reducing truncation errors", CACM 8, 1965
  const double step = seconds - time_lost_s_;
  const double sum = time_s_ + step;
  time_lost_s_ = (sum - time_s_) - step;
  time_s_ = sum;
}

/// Against what does not move, a flight ends where it must and as fast as its height says: by the motion's own sums an ulp
/// would be lost or gained on every bounce, the same way each time.
void EventDriven::place(const Next& impact) {
  const std::size_t contact = impact.contact;
  if (contact == line_.size()) {
    motion_.position_m[contact - 1] = line_.high_wall_m - line_.radius_m[contact - 1];
    motion_.velocity_m_s[contact - 1] = impact.approach_m_s;
  } else if (contact == resting_) {
    const double floor_m =
        contact == 0 ? line_.low_wall_m : motion_.position_m[contact - 1] + line_.radius_m[contact - 1];
    motion_.position_m[contact] = floor_m + line_.radius_m[contact];
    motion_.velocity_m_s[contact] = -impact.approach_m_s;
  }
}

void EventDriven::answer(const Next& impact) {
  place(impact);
  const double touching_m = touching_gap(line_, motion_);
  for (std::size_t at = 0; at <= line_.size(); ++at)
    touching_[at] = at == impact.contact || gap(line_, motion_.position_m, at) <= touching_m;
  impacts_ += resolve_impacts(line_, touching_, restitution_, resting_speed_m_s_, motion_.velocity_m_s, solve_);
  resting_ = 0;
  if (!(line_.gravity_m_s2 < 0)) return;
  while (resting_ < line_.size() && touching_[resting_] &&
         gap_rate(line_, motion_.velocity_m_s, resting_) <= resting_speed_m_s_) {
    motion_.velocity_m_s[resting_++] = 0;
  }
}

bool EventDriven::advance_to_impact() {
  const Next next = next_impact();
  if (next.seconds == std::numeric_limits<double>::infinity()) return false;
  move(next.seconds);
  answer(next);
  return true;
}

void EventDriven::advance(double seconds) {
  double left = seconds;
  for (Next next = next_impact(); next.seconds <= left; next = next_impact()) {
    move(next.seconds);
    left -= next.seconds;
    answer(next);
  }
  move(left);
}

}  // namespace collided::response
