#include "client/response/event_driven.hpp"

#include <algorithm>
#include <stdexcept>

#include "client/response/stepper.hpp"

namespace collided::response {

EventDriven::EventDriven(Line line, Motion start, double restitution, double resting_speed_m_s)
    : line_(std::move(line)), motion_(std::move(start)), restitution_(restitution), resting_speed_m_s_(resting_speed_m_s) {
  if (restitution_ < 1 && !(resting_speed_m_s_ > 0)) throw std::invalid_argument("restitution below 1 needs a resting speed above 0");
  if (deepest_penetration(line_, motion_) > touching_gap(line_, motion_)) throw std::invalid_argument("rigid bodies overlap at the start");
  touching_.resize(line_.size() + 1);
}

EventDriven::Next EventDriven::next_impact() const {
  Next next{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t contact = resting_; contact <= line_.size(); ++contact) {
    const double above = contact == line_.size() ? 0 : body_acceleration(contact);
    const double below = contact == 0 ? 0 : body_acceleration(contact - 1);
    const double seconds = time_to_touch(gap(line_, motion_.position_m, contact), gap_rate(line_, motion_.velocity_m_s, contact), above - below);
    if (seconds < next.seconds) next = {seconds, contact};
  }
  return next;
}

void EventDriven::move(double seconds) {
  for (std::size_t body = resting_; body < line_.size(); ++body) {
    motion_.position_m[body] += (motion_.velocity_m_s[body] + 0.5 * line_.gravity_m_s2 * seconds) * seconds;
    motion_.velocity_m_s[body] += line_.gravity_m_s2 * seconds;
  }
  time_s_ += seconds;
}

void EventDriven::answer(std::size_t contact) {
  const double touching_m = touching_gap(line_, motion_);
  for (std::size_t at = 0; at <= line_.size(); ++at) touching_[at] = at == contact || gap(line_, motion_.position_m, at) <= touching_m;
  impacts_ += resolve_impacts(line_, touching_, restitution_, resting_speed_m_s_, motion_.velocity_m_s, solve_);
  resting_ = 0;
  if (!(line_.gravity_m_s2 < 0)) return;
  while (resting_ < line_.size() && touching_[resting_] && gap_rate(line_, motion_.velocity_m_s, resting_) <= resting_speed_m_s_) {
    motion_.velocity_m_s[resting_++] = 0;
  }
}

bool EventDriven::advance_to_impact() {
  const Next next = next_impact();
  if (next.seconds == std::numeric_limits<double>::infinity()) return false;
  move(next.seconds);
  answer(next.contact);
  return true;
}

void EventDriven::advance(double seconds) {
  double left = seconds;
  for (Next next = next_impact(); next.seconds <= left; next = next_impact()) {
    move(next.seconds);
    left -= next.seconds;
    answer(next.contact);
  }
  move(left);
}

}  // namespace collided::response
