#include "server/world/events/contact_ledger.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

namespace collided::engine {
namespace {

OpenContact opened(const FoundContact& found, std::int64_t world_time_ns) {
  return {.a = found.a,
          .b = found.b,
          .a_triangle = found.a_triangle,
          .b_triangle = found.b_triangle,
          .began_ns = world_time_ns - std::llround(found.bracket_high_s * 1e9),
          .contact = found.contact,
          .surface = found.contact};
}

OpenContact doubted(const FoundContact& found, Doubt why, std::int64_t world_time_ns) {
  OpenContact of = opened(found, world_time_ns);
  // The two may touch from the first undecided instant on.
  of.began_ns = world_time_ns - std::llround(found.bracket_low_s * 1e9);
  of.doubt = why;
  of.a_triangle = of.b_triangle = kNoTriangle;
  of.contact = Contact{};
  of.contact.depth_m = 0;
  of.contact.depth_error_m = std::numeric_limits<double>::infinity();
  of.surface = of.contact;
  return of;
}

}  // namespace

std::size_t ContactLedger::PairHash::operator()(const Pair& pair) const {
  // Multiplicative hashing (Knuth, TAOCP 3, 6.4) of both slots; generations differ only between uses of a slot.
  const std::uint64_t mixed = (pair.a * 0x9e3779b97f4a7c15u) ^ ((pair.b + 0x7f4a7c15u) * 0xc2b2ae3d27d4eb4fu);
  return static_cast<std::size_t>(mixed ^ (mixed >> 29));
}

void ContactLedger::begin_step(std::int64_t world_time_ns, bool persisted_wanted) {
  events_.clear();
  ++step_;
  world_time_ns_ = world_time_ns;
  persisted_wanted_ = persisted_wanted;
}

void ContactLedger::touches(const FoundContact& found) {
  assert(found.a < found.b && "a pair is named by its lower id first");
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  end_doubt(found);
  if (!is_open(found.a, found.b)) return open(opened(found, world_time_ns_), found);
  goes_on(found);
  if (!persisted_wanted_) return;
  events_.push_back({.kind = EventKind::persisted,
                     .of = open_[index_.at({found.a, found.b})],
                     .relative_velocity = found.relative_velocity,
                     .velocity_error = found.velocity_error});
}

void ContactLedger::open(const OpenContact& opened, const FoundContact& found) {
  index_.emplace(Pair{opened.a, opened.b}, open_.size());
  open_.push_back(opened);
  found_in_step_.push_back(step_);
  doubt_count_ += opened.doubt != Doubt::none ? 1 : 0;
  events_.push_back({.kind = EventKind::began,
                     .of = opened,
                     .bracket_low_s = found.bracket_low_s,
                     .bracket_high_s = found.bracket_high_s,
                     .relative_velocity = found.relative_velocity,
                     .velocity_error = found.velocity_error});
}

bool ContactLedger::holds(ObjectId a, ObjectId b) const {
  const auto found = index_.find({a, b});
  return found != index_.end() && open_[found->second].doubt == Doubt::none;
}

bool ContactLedger::is_in_doubt(ObjectId a, ObjectId b) const { return is_open(a, b) && !holds(a, b); }

void ContactLedger::doubts(const FoundContact& found, Doubt why) {
  const auto place = index_.find({found.a, found.b});
  if (place == index_.end()) return open(doubted(found, why, world_time_ns_), found);
  found_in_step_[place->second] = step_;
}

void ContactLedger::lose(ObjectId object) {
  lost_.insert(object);
  std::vector<FoundContact> held;
  for (const OpenContact& open : open_) {
    if ((open.a == object || open.b == object) && open.doubt == Doubt::none)
      held.push_back({.a = open.a, .b = open.b, .contact = {}});
  }
  for (const FoundContact& found : held) {
    end(index_.at({found.a, found.b}), {.reason = EndReason::publisher_lost});
    doubts(found, Doubt::publisher_lost);
  }
}

bool ContactLedger::is_found_again(ObjectId a, ObjectId b) const {
  const auto found = index_.find(a < b ? Pair{a, b} : Pair{b, a});
  return found != index_.end() && open_[found->second].doubt == Doubt::publisher_lost && !has_lost(a, b);
}

void ContactLedger::doubted_and_parted(const FoundContact& found, Doubt why) {
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  if (is_open(found.a, found.b)) return;
  passed(doubted(found, why, world_time_ns_), found, EndReason::decided);
}

void ContactLedger::decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s) {
  if (is_in_doubt(a, b) && !has_lost(a, b)) end(index_.at({a, b}), {EndReason::decided, bracket_low_s, bracket_high_s});
}

/// A contact is found where there was a doubt: the doubt ends as decided.
void ContactLedger::end_doubt(const FoundContact& found) {
  decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
}

void ContactLedger::goes_on(const FoundContact& found) {
  const std::size_t index = index_.at({found.a, found.b});
  OpenContact& open = open_[index];
  found_in_step_[index] = step_;
  open.contact = open.surface = found.contact;
  open.a_triangle = found.a_triangle;
  open.b_triangle = found.b_triangle;
}

void ContactLedger::parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s) {
  end(index_.at({a, b}), {reason, bracket_low_s, bracket_high_s});
}

void ContactLedger::touched_and_parted(const FoundContact& found) {
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  end_doubt(found);
  passed(opened(found, world_time_ns_), found, EndReason::separated);
}

void ContactLedger::passed(const OpenContact& opened, const FoundContact& found, EndReason reason) {
  Event event{.kind = EventKind::began,
              .of = opened,
              .bracket_low_s = found.bracket_low_s,
              .bracket_high_s = found.bracket_high_s,
              .relative_velocity = found.relative_velocity,
              .velocity_error = found.velocity_error};
  events_.push_back(event);
  event.kind = EventKind::ended;
  event.reason = reason;
  event.relative_velocity.setZero();
  event.velocity_error = 0;
  event.bracket_low_s = found.parted_low_s;
  event.bracket_high_s = found.parted_high_s;
  events_.push_back(event);
}

void ContactLedger::end_object(ObjectId object, EndReason reason) {
  lost_.erase(object);
  for (std::size_t i = 0; i < open_.size();) {
    if (open_[i].a == object || open_[i].b == object) {
      end(i, {.reason = reason});
    } else {
      ++i;
    }
  }
}

void ContactLedger::end(std::size_t index, const ContactEnd& of) {
  const bool is_doubt = open_[index].doubt != Doubt::none;
  const bool is_parted = of.reason == EndReason::separated || of.reason == EndReason::teleported;
  doubt_count_ -= is_doubt ? 1 : 0;
  events_.push_back({.kind = EventKind::ended,
                     .reason = is_doubt && is_parted ? EndReason::decided : of.reason,
                     .of = open_[index],
                     .bracket_low_s = of.bracket_low_s,
                     .bracket_high_s = of.bracket_high_s});
  index_.erase({open_[index].a, open_[index].b});
  if (index + 1 != open_.size()) {
    open_[index] = open_.back();
    found_in_step_[index] = found_in_step_.back();
    index_[{open_[index].a, open_[index].b}] = index;
  }
  open_.pop_back();
  found_in_step_.pop_back();
}

void ContactLedger::retell_corrected() {
  for (Event& event : events_) {
    const auto open = index_.find({event.of.a, event.of.b});
    const bool is_of_open = event.kind != EventKind::ended && open != index_.end() && found(open->second);
    if (is_of_open) event.of.surface = open_[open->second].surface;
  }
}

void ContactLedger::finish_step() {
  // Contacts from before this step end first: an object that was defined anew has another id, and a client that knows
  // it by its name must hear of the old one's end before the new one's beginning. A contact that begins and ends in
  // this step does so in that order, which stable sorting keeps.
  const auto is_old_end = [](const Event& e) { return e.kind == EventKind::ended && e.of.episode != 0; };
  std::stable_sort(events_.begin(), events_.end(), [&](const Event& x, const Event& y) {
    return std::tuple(!is_old_end(x), x.of.a, x.of.b) < std::tuple(!is_old_end(y), y.of.a, y.of.b);
  });
  // A pair may begin several times in a step: an end takes the last beginning before it, an open contact the last of
  // all.
  const std::uint64_t last_before = last_sequence_;
  std::uint64_t passing_episode = 0;
  for (Event& event : events_) {
    if (event.kind == EventKind::persisted) continue;
    event.sequence = ++last_sequence_;
    if (event.kind == EventKind::ended) {
      if (event.of.episode == 0) event.of.episode = passing_episode;
      continue;
    }
    event.of.episode = passing_episode = event.sequence;
    const auto open = index_.find({event.of.a, event.of.b});
    const bool opened_now =
        open != index_.end() && (open_[open->second].episode == 0 || open_[open->second].episode > last_before);
    if (opened_now) open_[open->second].episode = event.sequence;
  }
}

}  // namespace collided::engine
