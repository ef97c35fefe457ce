#include "client/library/watching/watch_state.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "client/library/watching/standing_news.hpp"

namespace collided::client {
namespace {

// The number that the server's event writer keeps; older events could not be recovered anyway.
constexpr std::size_t kMostRecent = wire_contract::kEventTopic.keep_last;

// Two servers derive the same events from the same poses; this is the rounding of the transmitted times.
constexpr std::chrono::nanoseconds kRounded{2};
// Maximum delay between two servers in the effects of commands.
constexpr std::chrono::seconds kCommandsApart{1};
// Maximum age of repeated events.
constexpr std::chrono::seconds kToldAgain{10};

std::pair<std::uint64_t, std::uint64_t> pair_of(const Event& event) { return {event.a_id, event.b_id}; }

std::uint64_t hash_of(const Event& event) { return wire_contract::contact_hash(event.a_id, event.b_id, event.episode); }

template <class News>
News as_open(const News& event) {
  News open = event;
  open.kind = EventKind::open;
  open.reason = EndReason::none;
  if (event.kind == EventKind::emerged) open.contained = Containment::none;
  return open;
}

/// The name of the inner object, since the order of the two changes with their ids.
std::string inner_name(const Event& event) {
  if (event.contained == Containment::none) return {};
  return event.contained == Containment::a_in_b ? event.a : event.b;
}

bool is_change_of_containment(const Event& event) {
  return event.kind == EventKind::contained || event.kind == EventKind::emerged;
}

/// When a contact began, by the bracket of its `began`. A doubt begins at the first undecided instant.
std::chrono::nanoseconds start_of(const Event& began) {
  if (began.doubt == Doubt::none) return happened(began);
  return began.world_time - std::chrono::nanoseconds(std::llround(began.bracket_low_s * 1e9));
}

Containment turned_round(Containment which) {
  if (which == Containment::none) return which;
  return which == Containment::a_in_b ? Containment::b_in_a : Containment::a_in_b;
}

/// News of a contact, with the names under which it was reported: a shard too large for names omits them.
template <class News>
News named_as(const News& told, News news) {
  take_names(told, news);
  news.began = told.began;
  return news;
}

/// True for the beginning of a crossing, which has already ended when it is reported.
bool is_passing(const Event&) { return false; }
bool is_passing(const StandingNews& news) { return news.is_silent && news.kind == EventKind::began; }

/// For a nearest object whose end was missed: the event `next` reports that `before` is no longer the nearest.
void supersede(Event&, Event&) {}
void supersede(StandingNews& before, StandingNews& next) {
  before.is_superseded = before.reported.form == StandingForm::nearest;
  if (before.is_superseded) next.reported.other = before.a;
}

}  // namespace

std::pair<std::string, std::string> names_of(const Event& event) { return std::minmax(event.a, event.b); }

void take_names(const Event& from, Event& to) {
  to.a = from.a;
  to.b = from.b;
}

// ---- the server's lives --------------------------------------------------------------------------------------------

template <class News>
bool WatchStateOf<News>::is_current(const ServerLife& from, Clock::time_point now) {
  // A smaller epoch is that of an earlier server, which may have been suspended and resumed.
  const auto heir_after = [&] {
    return from.epoch < life_->epoch ? wire_contract::kForgottenNs : wire_contract::kStatusLostNs;
  };
  if (!life_ ||
      (from != *life_ && (from.epoch > life_->epoch || now - last_heard_ > std::chrono::nanoseconds(heir_after())))) {
    start_life(from);
  }
  if (from != *life_) { return false; }
  last_heard_ = now;
  return true;
}

template <class News>
void WatchStateOf<News>::start_life(const ServerLife& life) {
  for (auto& [pair, contact] : held_) { carried_.insert_or_assign(place_of(contact), std::move(contact)); }
  held_.clear();
  held_by_place_.clear();
  told_.clear();
  told_to_ = {};
  if (mode_ != Mode::starting) {
    told_to_ = std::max(joined_, bookmark_ ? bookmark_->world_time : std::chrono::nanoseconds(0));
    for (const Entry& entry : recent_) { note_told(entry.event); }
  }
  if (mode_ != Mode::starting && life_) {
    life_change_ = {.changes = life_change_.changes + 1, .before = *life_, .now = life, .heard_from = 0};
  }
  life_ = life;
  settled_ = {};
  settled_.life = life;
  applied_ = run_start_ = 0;
  shards_ = {};
  recent_.clear();
  bookmark_.reset();
  behind_at_.reset();
  stuck_ = false;
  if (mode_ != Mode::starting) {
    mode_ = Mode::doubtful;
    ++resyncs_;
    has_gap_ = false;
  }
}

template <class News>
void WatchStateOf<News>::note_heard_from(std::uint64_t sequence) {
  if (run_start_ != 0 || life_change_.changes == 0) { return; }
  std::uint64_t& from = life_change_.heard_from;
  from = from == 0 ? sequence : std::min(from, sequence);
}

/// Counts a gap: something was, or may have been, missed.
template <class News>
void WatchStateOf<News>::note_gap() {
  if (!std::exchange(has_gap_, true)) { ++gaps_; }
}

/// Takes a watermark, unless one of the events that it counts on has yet to come: the frame with that has another one.
template <class News>
void WatchStateOf<News>::note_settled(std::chrono::nanoseconds to, std::uint64_t through, Clock::time_point now) {
  if (to.count() == 0 || through > applied_ || !in_step()) { return; }
  settled_.to = std::max(settled_.to, to);
  settled_.came = now;
}

template <class News>
void WatchStateOf<News>::note_told(const News& event) {
  if (event.reason == EndReason::server_stopping) { return; }  // about the server; an heir still has the contact
  Told& told = told_[names_of(event)];
  const std::chrono::nanoseconds time = happened(event);
  if (time > told.time + kRounded) { told = {.time = time, .kinds = 0}; }
  if (time >= told.time - kRounded) { told.kinds |= 1U << static_cast<unsigned>(event.kind); }
  told_to_ = std::max(told_to_, event.world_time);
}

template <class News>
bool WatchStateOf<News>::was_told(const News& event, const News& last, bool is_again) const {
  if (told_to_.count() == 0) { return false; }
  const News& newest = event.kind == EventKind::began ? last : event;
  const std::chrono::nanoseconds time = happened(newest);
  const auto told = told_.find(names_of(event));
  if (told != told_.end()) {
    const bool is_kind_told = (told->second.kinds & (1U << static_cast<unsigned>(newest.kind))) != 0;
    const bool is_then = time >= told->second.time - kRounded && time <= told->second.time + kRounded;
    if (is_then && is_kind_told) { return true; }
    if (is_again && time < told->second.time - kRounded) { return true; }
  }
  if (!is_again) { return false; }
  if (time <= joined_) { return true; }  // included in the state adopted first
  if (held_.contains(pair_of(event)) || is_carried(event)) { return false; }
  // The end of an unknown contact was already reported.
  return event.kind != EventKind::began && time <= told_to_ + kCommandsApart;
}

/// True if the end of a contact in a new life's state was already reported; the new server has not derived it yet.
template <class News>
bool WatchStateOf<News>::has_ended_before(const News& contact) const {
  const auto told = told_.find(names_of(contact));
  return told != told_.end() && (told->second.kinds & (1U << static_cast<unsigned>(EventKind::ended))) != 0 &&
         told->second.time > contact.began + kRounded;
}

template <class News>
void WatchStateOf<News>::doubt() {
  if (mode_ != Mode::starting) { note_gap(); }
  if (mode_ == Mode::in_step) {
    mode_ = Mode::doubtful;
    ++resyncs_;
  }
}

// ---- events --------------------------------------------------------------------------------------------------------

template <class News>
void WatchStateOf<News>::hear(const HeardFrameOf<News>& frame, Clock::time_point now) {
  if (!is_current(frame.from, now)) { return; }
  std::uint64_t sequence = frame.first_sequence;
  for (auto next = frame.entries.begin(); next != frame.entries.end(); ++sequence) {
    const auto first = next;
    while (next->joins_next && std::next(next) != frame.entries.end()) ++next;
    const Entry& last = *next++;
    if (run_start_ != 0 && sequence <= applied_) { continue; }
    note_heard_from(sequence);
    const bool is_first_of_life = run_start_ == 0 && mode_ == Mode::doubtful;
    if (mode_ != Mode::starting && !is_first_of_life && sequence != applied_ + 1) { doubt(); }
    if (run_start_ == 0 || sequence != applied_ + 1) { run_start_ = sequence; }
    applied_ = sequence;
    for (auto part = first; part != next; ++part) {
      Entry entry = *part;
      entry.event.sequence = sequence;
      entry.event.epoch = frame.from.epoch;
      note(entry);
      if (mode_ != Mode::starting && !was_told(entry.event, last.event, frame.is_again)) { apply(entry.event); }
    }
  }
  note_settled(frame.settled_to, sequence - 1, now);
}

template <class News>
void WatchStateOf<News>::note(const Entry& entry) {
  if (recent_.size() >= kMostRecent) {
    while (recent_.front().joins_next && recent_.size() > 1) recent_.pop_front();
    recent_.pop_front();
  }
  recent_.push_back(entry);
}

template <class News>
void WatchStateOf<News>::apply(const News& event) {
  if (event.kind == EventKind::began) {
    apply_began(event);
  } else if (event.kind == EventKind::ended) {
    apply_ended(event);
  } else if (is_change_of_containment(event)) {
    apply_containment(event);
  }
}

template <class News>
void WatchStateOf<News>::apply_began(const News& event) {
  const auto held = held_.find(pair_of(event));
  if (held != held_.end()) {
    if (held->second.episode == event.episode) { return; }
    doubt();
    emit_missed(held->second, EventKind::ended, EndReason::none, event.sequence);
    release(held);
  }
  // A crossing implies that the object's stay of an earlier life has ended.
  if (!is_passing(event) && carry_over(event)) { return; }
  News began = event;
  end_namesake(began);
  began.began = start_of(event);
  began.contained = Containment::none;
  hold(as_open(began));
  emit_(began);
}

template <class News>
void WatchStateOf<News>::hold(const News& contact) {
  held_.insert_or_assign(pair_of(contact), contact);
  held_by_place_.insert_or_assign(place_of(contact), pair_of(contact));
}

template <class News>
auto WatchStateOf<News>::release(Held held) -> Held {
  const auto named = held_by_place_.find(place_of(held->second));
  if (named != held_by_place_.end() && named->second == held->first) held_by_place_.erase(named);
  return held_.erase(held);
}

/// A name belongs to one object at a time. An event with the same names and other ids thus means that an object was
/// redefined, and that the end of the contact with these names was missed.
template <class News>
void WatchStateOf<News>::end_namesake(News& event) {
  const auto carried = carried_.empty() ? carried_.end() : carried_.find(place_of(event));
  if (carried != carried_.end() && (is_passing(event) || names_of(carried->second) != names_of(event))) {
    supersede(carried->second, event);
    emit_missed(carried->second, EventKind::ended, EndReason::none, event.sequence);
    carried_.erase(carried);
  }
  const auto named = held_by_place_.find(place_of(event));
  if (named == held_by_place_.end() || named->second == pair_of(event)) { return; }
  doubt();
  const auto held = held_.find(named->second);
  supersede(held->second, event);
  emit_missed(held->second, EventKind::ended, EndReason::none, event.sequence);
  release(held);
}

template <class News>
void WatchStateOf<News>::apply_ended(const News& event) {
  if (!held_.contains(pair_of(event))) { carry_over(event); }
  auto held = held_.find(pair_of(event));
  if (held == held_.end() || held->second.episode != event.episode) { held = begin_missed(event); }
  News ended = named_as(held->second, event);
  if (held->second.contained != Containment::none) change_missed(held->second, ended, event.sequence);
  release(held);
  emit_(ended);
}

/// Begins a contact whose beginning was missed.
template <class News>
auto WatchStateOf<News>::begin_missed(const News& event) -> Held {
  doubt();
  const auto held = held_.find(pair_of(event));
  if (held != held_.end()) {
    emit_missed(held->second, EventKind::ended, EndReason::none, event.sequence);
    release(held);
  }
  News contact = as_open(event);
  end_namesake(contact);
  contact.contained = event.kind == EventKind::emerged ? event.contained : Containment::none;
  contact.began = happened(event);  // its real beginning is unknown
  emit_missed(contact, EventKind::began, EndReason::none, event.sequence);
  hold(contact);
  return held_.find(pair_of(event));
}

template <class News>
void WatchStateOf<News>::apply_containment(const News& event) {
  if (!held_.contains(pair_of(event))) { carry_over(event, false); }
  auto held = held_.find(pair_of(event));
  if (held == held_.end() || held->second.episode != event.episode) { held = begin_missed(event); }
  const Containment now = event.kind == EventKind::contained ? event.contained : Containment::none;
  if (held->second.contained == now) { return; }
  held->second.contained = now;
  emit_(named_as(held->second, event));
}

/// Emits missed changes of containment of an open contact.
template <class News>
void WatchStateOf<News>::change_missed(News& held, const News& news, std::uint64_t sequence) {
  if (held.contained == news.contained) { return; }
  if (held.contained != Containment::none) { emit_missed(held, EventKind::emerged, EndReason::none, sequence); }
  held.contained = news.contained;
  if (held.contained != Containment::none) { emit_missed(held, EventKind::contained, EndReason::none, sequence); }
}

template <class News>
void WatchStateOf<News>::hear_persisted(const HeardFrameOf<News>& frame) {
  if (life_ != frame.from || mode_ == Mode::starting) { return; }
  for (const Entry& entry : frame.entries) {
    const auto held = held_.find(pair_of(entry.event));
    if (entry.event.kind != EventKind::persisted || held == held_.end() ||
        held->second.episode != entry.event.episode) {
      continue;
    }
    News persisted = named_as(held->second, entry.event);
    persisted.epoch = frame.from.epoch;
    persisted.sequence = applied_;
    emit_(persisted);
  }
}

template <class News>
bool WatchStateOf<News>::is_carried(const News& event) const {
  if (carried_.empty()) { return false; }
  const auto carried = carried_.find(place_of(event));
  return carried != carried_.end() && names_of(carried->second) == names_of(event);
}

// Ids of an earlier life are invalid in this one, so pairs are identified by their names.
template <class News>
bool WatchStateOf<News>::carry_over(const News& event, bool tells_containment) {
  if (!is_carried(event)) { return false; }
  const auto carried = carried_.find(place_of(event));
  News contact = as_open(event);
  contact.began = carried->second.began;
  const News before = carried->second;
  carried_.erase(carried);
  hold(contact);
  News& held = held_.find(pair_of(contact))->second;
  if (inner_name(before) == inner_name(contact)) { return true; }
  held.contained = before.a == held.a ? before.contained : turned_round(before.contained);
  if (tells_containment) { change_missed(held, contact, event.sequence); }
  return true;
}

template <class News>
void WatchStateOf<News>::emit_missed(const News& contact, EventKind what, EndReason why, std::uint64_t sequence) {
  News missed = contact;
  // `emerged` precedes `ended`, and `contained` follows `began`.
  const bool was_contained = contact.contained != Containment::none;
  if (what == EventKind::ended && was_contained) emit_missed(contact, EventKind::emerged, why, sequence);
  if (what == EventKind::began || what == EventKind::ended) missed.contained = Containment::none;
  if (what != EventKind::open) { note_gap(); }
  missed.kind = what;
  missed.reason = why;
  missed.resync = true;
  missed.sequence = sequence;
  missed.epoch = life_->epoch;
  emit_(missed);
  if (what == EventKind::began && was_contained) emit_missed(contact, EventKind::contained, why, sequence);
}

// ---- state ---------------------------------------------------------------------------------------------------------

template <class News>
void WatchStateOf<News>::hear(const HeardShardOf<News>& shard, Clock::time_point now) {
  if (!is_current(shard.from, now) || shard.shard >= shards_.size() ||
      shard.as_of_sequence < shards_[shard.shard].as_of_sequence) {
    return;
  }
  shards_[shard.shard] = {shard.as_of_sequence, shard.contacts};
  try_adopt();
}

template <class News>
void WatchStateOf<News>::hear(const HeardBookmark& bookmark, Clock::time_point now) {
  if (!is_current(bookmark.from, now)) { return; }
  bookmark_ = bookmark;
  if (told_to_.count() != 0 && bookmark.world_time > told_to_ + kToldAgain) {
    told_.clear();
    told_to_ = {};
  }
  stuck_ = false;
  note_heard_from(bookmark.last_event_sequence + 1);
  if (bookmark.last_event_sequence <= applied_) {
    behind_at_.reset();
  } else if (behind_at_ == applied_) {
    stuck_ = true;  // the last events were lost, and no later event reveals the gap
    if (run_start_ != 0 || mode_ == Mode::in_step) { doubt(); }
  } else {
    behind_at_ = applied_;
  }
  if (mode_ == Mode::in_step && bookmark.last_event_sequence == applied_) {
    std::uint64_t hash = 0;
    for (const auto& [pair, contact] : held_) { hash += hash_of(contact); }
    if (hash != bookmark.contact_hash || held_.size() != bookmark.contact_count) { doubt(); }
  }
  try_adopt();
  settled_.heir_of = bookmark.heir_of;
  settled_.told_from = bookmark.told_from;
  note_settled(bookmark.settled_to, bookmark.last_event_sequence, now);
}

template <class News>
void WatchStateOf<News>::try_adopt() {
  if (mode_ == Mode::in_step || !bookmark_ || !may_adopt() || !bookmark_vouches()) { return; }
  if (mode_ == Mode::starting) {
    adopt_first();
  } else {
    adopt_differences();
  }
}

template <class News>
bool WatchStateOf<News>::may_adopt() const {
  const std::uint64_t at = bookmark_->last_event_sequence;
  // Events after the bookmark must be known without a gap, since they are applied to its state.
  const bool tail_known =
      applied_ <= at || (run_start_ <= at + 1 && !recent_.empty() && recent_.front().event.sequence <= at + 1);
  // Late events will still come, and have more information than differences.
  const bool nothing_late = mode_ == Mode::starting || applied_ >= at || stuck_;
  const bool shards_in_time =
      std::all_of(shards_.begin(), shards_.end(), [&](const Shard& shard) { return shard.as_of_sequence <= at; });
  return tail_known && nothing_late && shards_in_time;
}

// True if the state that state_at() would build matches the bookmark.
template <class News>
bool WatchStateOf<News>::bookmark_vouches() const {
  std::uint64_t hash = 0;
  std::uint64_t count = 0;
  for (const Shard& shard : shards_) {
    for (const News& contact : shard.contacts) {
      hash += hash_of(contact);
      ++count;
    }
  }
  for (const Entry& entry : recent_) {
    const std::uint64_t sequence = entry.event.sequence;
    if (sequence > bookmark_->last_event_sequence || entry.shard >= shards_.size() ||
        sequence <= shards_[entry.shard].as_of_sequence) {
      continue;
    }
    if (entry.event.kind == EventKind::began) {
      hash += hash_of(entry.event);
      ++count;
    } else if (entry.event.kind == EventKind::ended) {
      hash -= hash_of(entry.event);
      --count;
    }
  }
  return hash == bookmark_->contact_hash && count == bookmark_->contact_count;
}

template <class News>
auto WatchStateOf<News>::state_at(std::uint64_t sequence) const -> Contacts {
  Contacts state;
  for (const Shard& shard : shards_) {
    for (const News& contact : shard.contacts) { state.insert_or_assign(pair_of(contact), contact); }
  }
  for (const Entry& entry : recent_) {
    if (entry.event.sequence > sequence || entry.shard >= shards_.size() ||
        entry.event.sequence <= shards_[entry.shard].as_of_sequence) {
      continue;
    }
    if (entry.event.kind == EventKind::ended) {
      state.erase(pair_of(entry.event));
    } else if (entry.event.kind == EventKind::began) {
      News contact = as_open(entry.event);
      contact.began = start_of(entry.event);
      state.insert_or_assign(pair_of(entry.event), contact);
    } else if (is_change_of_containment(entry.event)) {
      const auto contact = state.find(pair_of(entry.event));
      if (contact != state.end()) contact->second.contained = as_open(entry.event).contained;
    }
  }
  return state;
}

template <class News>
void WatchStateOf<News>::adopt_first() {
  const std::uint64_t at = bookmark_->last_event_sequence;
  mode_ = Mode::in_step;
  joined_ = bookmark_->world_time;
  for (auto&& [pair, contact] : state_at(at)) {
    end_namesake(contact);
    hold(contact);
    emit_missed(contact, EventKind::open, EndReason::none, at);
  }
  const std::deque<Entry> recent = recent_;
  for (const Entry& entry : recent) {
    if (entry.event.sequence > at) { apply(entry.event); }
  }
  if (applied_ < at) {
    applied_ = at;
    run_start_ = at + 1;
  }
}

template <class News>
void WatchStateOf<News>::adopt_differences() {
  const std::uint64_t at = std::max(applied_, bookmark_->last_event_sequence);
  Contacts state = state_at(at);
  for (auto held = held_.begin(); held != held_.end();) {
    const auto found = state.find(held->first);
    if (found != state.end() && found->second.episode == held->second.episode) {
      change_missed(held->second, found->second, at);
      ++held;
      continue;
    }
    News ended = held->second;
    ended.world_time = bookmark_->world_time;
    emit_missed(ended, EventKind::ended, EndReason::none, at);
    held = release(held);
  }
  for (auto& [pair, contact] : state) {
    if (!held_.contains(pair) && !carry_over(contact) && !has_ended_before(contact)) {
      end_namesake(contact);
      emit_missed(contact, EventKind::began, EndReason::none, at);
      hold(contact);
    }
  }
  if (applied_ < at) {
    applied_ = at;
    run_start_ = at + 1;
  }
  if (bookmark_->settled) { end_carried(); }
  if (carried_.empty()) {
    mode_ = Mode::in_step;
    has_gap_ = false;
  }
}

template <class News>
void WatchStateOf<News>::end_carried() {
  const std::map<Names, News> gone = std::exchange(carried_, {});
  for (const auto& [names, contact] : gone) {
    News ended = contact;
    ended.world_time = bookmark_->world_time;
    emit_missed(ended, EventKind::ended, EndReason::server_restarted, applied_);
  }
}

template class WatchStateOf<Event>;
template class WatchStateOf<StandingNews>;

}  // namespace collided::client
