#include "server/world/events/contact_ledger.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "server/world/objects/column.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kKept = 1'024;  // events and contacts: room for this many is not given back

template <class T>
bool has_far_more_room(const std::vector<T>& list) {
  return list.capacity() > kKept && 16 * list.size() < list.capacity();
}

}  // namespace

OpenContact ContactLedger::opened(const FoundContact& found) const {
  return {.a = found.a,
          .b = found.b,
          .a_triangle = found.a_triangle,
          .b_triangle = found.b_triangle,
          .began_ns = world_time_ns_ - std::llround(found.bracket_high_s * 1e9),
          .contact = found.contact,
          .surface = found.surface.value_or(found.contact),
          .contained = found.contained};
}

OpenContact ContactLedger::doubted(const FoundContact& found, Doubt why) const {
  OpenContact of = opened(found);
  // The two may touch from the first undecided instant on.
  of.began_ns = world_time_ns_ - std::llround(found.bracket_low_s * 1e9);
  of.doubt = why;
  of.a_triangle = of.b_triangle = kNoTriangle;
  of.contained = Contained::none;
  of.contact = Contact{};
  of.contact.depth_m = 0;
  of.contact.depth_error_m = std::numeric_limits<double>::infinity();
  of.surface = of.contact;
  return of;
}

void ContactLedger::begin_step(std::int64_t world_time_ns, bool persisted_wanted) {
  // Give back memory after peaks: the first step of a large world begins all its contacts at once.
  if (has_far_more_room(events_)) events_ = std::vector<Event>();
  if (has_far_more_room(open_)) {
    open_.shrink_to_fit();
    found_in_step_.shrink_to_fit();
    links_.give_back();
  }
  events_.clear();
  for (const std::uint32_t slot : found_slots_) is_slot_found_[slot] = 0;
  found_slots_.clear();
  ++step_;
  world_time_ns_ = world_time_ns;
  persisted_wanted_ = persisted_wanted;
}

void ContactLedger::mark_found(std::uint32_t number) {
  if (found_in_step_[number] == step_) return;
  found_in_step_[number] = step_;
  note_found_slot(place_of(open_[number].a));
  note_found_slot(place_of(open_[number].b));
}

void ContactLedger::note_found_slot(std::uint32_t slot) {
  if (slot >= is_slot_found_.size()) is_slot_found_.resize(slot + 1);
  if (is_slot_found_[slot] != 0) return;
  is_slot_found_[slot] = 1;
  found_slots_.push_back(slot);
}

void ContactLedger::touches(const FoundContact& found) {
  assert(found.a < found.b && "a pair is named by its lower id first");
  if (passes(found.a, found.b)) return;
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  std::uint32_t number = number_of(found.a, found.b);
  if (number != PairIndex::kNone && is_doubt(number)) {
    // A contact is found for a pair in doubt: the doubt ends as decided.
    end(number, {EndReason::decided, found.bracket_low_s, found.bracket_high_s});
    number = PairIndex::kNone;
  }
  if (number == PairIndex::kNone) return open(opened(found), found);
  goes_on(number, found);
  changes_containment(number, found.contained, {EndReason::none, found.bracket_low_s, found.bracket_high_s});
  if (!persisted_wanted_) return;
  events_.push_back({.kind = EventKind::persisted,
                     .of = open_[number],
                     .relative_velocity = found.relative_velocity,
                     .velocity_error = found.velocity_error});
}

void ContactLedger::open(const OpenContact& opened, const FoundContact& found) {
  const auto number = static_cast<std::uint32_t>(open_.size());
  index_.add(opened.a, opened.b, number);
  links_.add({place_of(opened.a), has_faces(opened.b)}, {place_of(opened.b), has_faces(opened.a)},
             opened.doubt == Doubt::none);
  reserve_column(open_, open_.size() + 1, 4);
  open_.push_back(opened);
  reserve_column(found_in_step_, open_.size(), 4);
  found_in_step_.push_back(0);
  mark_found(number);
  doubt_count_ += opened.doubt != Doubt::none ? 1 : 0;
  events_.push_back({.kind = EventKind::began,
                     .of = opened,
                     .bracket_low_s = found.bracket_low_s,
                     .bracket_high_s = found.bracket_high_s,
                     .relative_velocity = found.relative_velocity,
                     .velocity_error = found.velocity_error});
  // It was outside before.
  const Contained to = std::exchange(open_[number].contained, Contained::none);
  changes_containment(number, to, {EndReason::none, found.parted_low_s, found.parted_high_s});
}

/// Reports that in an open contact one object came to lie within the other, or no longer does.
void ContactLedger::changes_containment(std::uint32_t number, Contained to, const ContactEnd& when) {
  OpenContact& open = open_[number];
  if (open.doubt != Doubt::none || open.contained == to) return;
  const auto tell = [&](EventKind kind) {
    events_.push_back({.kind = kind,
                       .reason = when.reason,
                       .of = open,
                       .bracket_low_s = when.bracket_low_s,
                       .bracket_high_s = when.bracket_high_s});
  };
  if (open.contained != Contained::none) tell(EventKind::emerged);
  open.contained = to;
  links_.set_at_faces(number, to == Contained::none);
  if (to != Contained::none) tell(EventKind::contained);
}

Contained ContactLedger::contained(ObjectId a, ObjectId b) const {
  const std::uint32_t number = number_of(a, b);
  return number == PairIndex::kNone ? Contained::none : open_[number].contained;
}

bool ContactLedger::holds(ObjectId a, ObjectId b) const {
  const std::uint32_t number = number_of(a, b);
  return number != PairIndex::kNone && !is_doubt(number);
}

bool ContactLedger::is_in_doubt(ObjectId a, ObjectId b) const {
  const std::uint32_t number = number_of(a, b);
  return number != PairIndex::kNone && is_doubt(number);
}

void ContactLedger::doubts(const FoundContact& found, Doubt why) {
  if (passes(found.a, found.b)) return;
  const std::uint32_t number = number_of(found.a, found.b);
  if (number == PairIndex::kNone) return open(doubted(found, why), found);
  mark_found(number);
}

void ContactLedger::lose(ObjectId object) {
  lost_.insert(object);
  std::vector<FoundContact> held;
  links_.for_each(place_of(object), [&](std::uint32_t number) {
    const OpenContact& open = open_[number];
    if (open.doubt == Doubt::none) held.push_back({.a = open.a, .b = open.b, .contact = {}});
    return true;
  });
  for (const FoundContact& found : held) {
    end(number_of(found.a, found.b), {.reason = EndReason::publisher_lost});
    doubts(found, Doubt::publisher_lost);
  }
}

bool ContactLedger::is_found_again(ObjectId a, ObjectId b) const {
  const std::uint32_t number = number_of(std::min(a, b), std::max(a, b));
  return number != PairIndex::kNone && open_[number].doubt == Doubt::publisher_lost && !has_lost(a, b);
}

void ContactLedger::doubted_and_parted(const FoundContact& found, Doubt why) {
  if (passes(found.a, found.b)) return;
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  if (is_open(found.a, found.b)) return;
  passed(doubted(found, why), found, EndReason::decided);
}

void ContactLedger::decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s) {
  const std::uint32_t number = number_of(a, b);
  if (number != PairIndex::kNone && is_doubt(number) && !has_lost(a, b))
    end(number, {EndReason::decided, bracket_low_s, bracket_high_s});
}

/// Updates place and depth of a contact, without an event.
void ContactLedger::goes_on(std::uint32_t number, const FoundContact& found) {
  OpenContact& open = open_[number];
  mark_found(number);
  open.contact = open.surface = found.contact;
  open.a_triangle = found.a_triangle;
  open.b_triangle = found.b_triangle;
}

void ContactLedger::parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s) {
  end(number_of(a, b), {reason, bracket_low_s, bracket_high_s});
}

void ContactLedger::touched_and_parted(const FoundContact& found, bool as_one) {
  if (passes(found.a, found.b)) return;
  if (has_lost(found.a, found.b)) return doubts(found, Doubt::publisher_lost);
  decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  passed(opened(found), found, is_of_fences_ ? EndReason::crossed : EndReason::separated, as_one);
}

void ContactLedger::passed(const OpenContact& opened, const FoundContact& found, EndReason reason, bool as_one) {
  Event event{.kind = EventKind::began,
              .reason = is_of_fences_ ? reason : EndReason::none,
              .of = opened,
              .bracket_low_s = found.bracket_low_s,
              .bracket_high_s = found.bracket_high_s,
              .relative_velocity = found.relative_velocity,
              .velocity_error = found.velocity_error,
              .joins_next = as_one};
  events_.push_back(event);
  event.joins_next = false;
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
  endings_.clear();
  links_.for_each(place_of(object), [&](std::uint32_t number) {
    endings_.push_back({{open_[number].a, open_[number].b}, {.reason = reason}});
    return true;
  });
  for (const Ending& ending : endings_) end(number_of(ending.pair.a, ending.pair.b), ending.end);
}

void ContactLedger::end_allowed() {
  endings_.clear();
  for (const OpenContact& open : open_) {
    if (passes(open.a, open.b)) endings_.push_back({{open.a, open.b}, {.reason = EndReason::allowed}});
  }
  for (const Ending& ending : endings_) end(number_of(ending.pair.a, ending.pair.b), ending.end);
}

void ContactLedger::end(std::uint32_t number, const ContactEnd& of) {
  const bool was_doubt = is_doubt(number);
  const bool is_parted = of.reason == EndReason::separated || of.reason == EndReason::teleported;
  doubt_count_ -= was_doubt ? 1 : 0;
  changes_containment(number, Contained::none, of);
  events_.push_back({.kind = EventKind::ended,
                     .reason = was_doubt && is_parted ? EndReason::decided : of.reason,
                     .of = open_[number],
                     .bracket_low_s = of.bracket_low_s,
                     .bracket_high_s = of.bracket_high_s});
  index_.remove(open_[number].a, open_[number].b, number);
  links_.remove(number);
  const auto last = static_cast<std::uint32_t>(open_.size() - 1);
  if (number != last) {
    index_.renumber(open_[last].a, open_[last].b, last, number);
    open_[number] = open_[last];
    found_in_step_[number] = found_in_step_[last];
  }
  open_.pop_back();
  found_in_step_.pop_back();
}

void ContactLedger::retell_corrected() {
  for (Event& event : events_) {
    if (event.kind == EventKind::ended) continue;
    const std::uint32_t number = number_of(event.of.a, event.of.b);
    if (number != PairIndex::kNone && found(number)) event.of.surface = open_[number].surface;
  }
}

void ContactLedger::retell_unsure(const std::function<bool(const OpenContact&)>& is_unsure) {
  for (Event& event : events_) {
    const bool is_parted = event.reason == EndReason::separated || event.reason == EndReason::teleported ||
                           event.reason == EndReason::decided;
    // An `emerged` has a reason only if its contact ends with it, and then has the reason of the end.
    const bool is_end = event.kind == EventKind::ended || event.kind == EventKind::emerged;
    if (is_end && is_parted && is_unsure(event.of)) event.reason = EndReason::removed;
  }
}

/// Joins each end to the beginning for the object that becomes nearest at the same time.
void ContactLedger::join_nearest() {
  for (std::size_t i = 0; i + 1 < events_.size(); ++i) {
    Event& event = events_[i];
    const Event& next = events_[i + 1];
    event.joins_next =
        event.joins_next || (is_nearest_question(event.of.b) && event.kind == EventKind::ended &&
                             next.of.b == event.of.b && next.kind == EventKind::began &&
                             next.bracket_low_s == event.bracket_low_s && next.bracket_high_s == event.bracket_high_s);
  }
}

void ContactLedger::finish_step() {
  // Contacts from before this step end first, with all their changes: a redefined object has another id, and a client
  // that knows it by name must receive the old one's end before the new one's beginning. A contact that begins and ends
  // in this step does so in that order, which stable sorting keeps.
  ended_episodes_.clear();
  for (const Event& event : events_) {
    if (event.kind == EventKind::ended && event.of.episode != 0) ended_episodes_.push_back(event.of.episode);
  }
  std::sort(ended_episodes_.begin(), ended_episodes_.end());
  const auto is_old_end = [&](const Event& e) {
    if (e.kind == EventKind::ended) return e.of.episode != 0;
    return (e.kind == EventKind::contained || e.kind == EventKind::emerged) &&
           std::binary_search(ended_episodes_.begin(), ended_episodes_.end(), e.of.episode);
  };
  // Changes of the nearest come last, those of each question in the order in which they were found.
  const auto place = [&](const Event& e) {
    const bool is_nearest = is_nearest_question(e.of.b);
    return std::tuple(is_nearest, is_nearest || !is_old_end(e), is_nearest ? 0 : e.of.a, e.of.b);
  };
  std::stable_sort(events_.begin(), events_.end(), [&](const Event& x, const Event& y) { return place(x) < place(y); });
  if (is_of_fences_) join_nearest();
  // A pair may begin several times in a step: an end belongs to the last beginning before it, an open contact to the
  // last of all.
  const std::uint64_t last_before = last_sequence_;
  std::uint64_t passing_episode = 0;
  bool is_joined = false;
  for (Event& event : events_) {
    if (event.kind == EventKind::persisted) continue;
    event.sequence = is_joined ? last_sequence_ : ++last_sequence_;
    is_joined = event.joins_next;
    if (event.kind != EventKind::began) {
      if (event.of.episode == 0) event.of.episode = passing_episode;
      continue;
    }
    event.of.episode = passing_episode = event.sequence;
    const std::uint32_t number = number_of(event.of.a, event.of.b);
    const bool opened_now =
        number != PairIndex::kNone && (open_[number].episode == 0 || open_[number].episode > last_before);
    if (opened_now) open_[number].episode = event.sequence;
  }
}

}  // namespace collided::engine
