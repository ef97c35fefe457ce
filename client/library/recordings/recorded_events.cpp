#include "client/library/recordings/recorded_events.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include "client/library/connection/errors.hpp"
#include "client/library/watching/pair_filter.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "collided/recording.hpp"
#include "idl/cdr.hpp"

namespace collided {
namespace client {
namespace {

using recording::Recorded;
using std::chrono::nanoseconds;
using Pair = std::pair<std::uint64_t, std::uint64_t>;

template <class News>
struct TimedMessage {
  std::uint64_t log_time = 0;
  std::variant<HeardFrameOf<News>, HeardShardOf<News>, HeardBookmark> heard;
};
template <class News>
using TimedMessages = std::vector<TimedMessage<News>>;

/// The messages in a recording. Messages that cannot be decoded count as lost, as for a live watch.
template <class News>
TimedMessages<News> messages_of(const RecordedItems& recorded, Names& names) {
  using Wire = WireOf<News>;
  TimedMessages<News> messages;
  dds::Sample<typename Wire::Frame> frame;
  dds::Sample<typename Wire::Shard> shard;
  dds::Sample<wire::Status> status;
  for (const RecordedItem& item : recorded.items) {
    if (item.topic == Wire::kRecordedFrames && wire::read_cdr(item.data, frame)) {
      if (auto heard = decode(*frame, names)) messages.push_back({item.log_time, std::move(*heard)});
    } else if (item.topic == Wire::kRecordedShards && wire::read_cdr(item.data, shard)) {
      if (const auto bookmark = bookmark_in(*shard)) messages.push_back({item.log_time, *bookmark});
      else if (auto heard = decode(*shard, names)) messages.push_back({item.log_time, std::move(*heard)});
    } else if (std::is_same_v<News, Event> && item.topic == Recorded::status && wire::read_cdr(item.data, status)) {
      messages.push_back({item.log_time, decode(*status)});
    }
  }
  return messages;
}

/// The events of one life of a server in a recording, by sequence number.
struct LifeSpan {
  std::uint64_t before = 0;  // the newest event before the recording
  std::uint64_t last = 0;    // the newest known event, recorded or not
  std::uint64_t heard = 0;

  std::uint64_t lost() const { return last - before > heard ? last - before - heard : 0; }
};

template <class News>
LifeSpan span_of_life(const ServerLife& life, const TimedMessages<News>& messages) {
  std::optional<std::uint64_t> first_event, first_bookmark, live_bookmark;
  LifeSpan span;
  for (const TimedMessage<News>& message : messages) {
    if (const auto* const frame = std::get_if<HeardFrameOf<News>>(&message.heard);
        frame != nullptr && frame->from == life && !frame->entries.empty()) {
      if (!first_event) first_event = std::max<std::uint64_t>(frame->first_sequence, 1);
      span.heard += frame->event_count();
      span.last = std::max<std::uint64_t>(span.last, frame->first_sequence + frame->event_count() - 1);
    }
    const auto* const bookmark = std::get_if<HeardBookmark>(&message.heard);
    if (bookmark == nullptr || bookmark->from != life) continue;
    // The first bookmark may be older than the recorder's subscription, since DDS keeps it for late joiners.
    if (first_bookmark && !live_bookmark) live_bookmark = bookmark->last_event_sequence;
    if (!first_bookmark) first_bookmark = bookmark->last_event_sequence;
    span.last = std::max(span.last, bookmark->last_event_sequence);
  }
  span.before = live_bookmark ? *live_bookmark : first_event ? *first_event - 1 : first_bookmark.value_or(0);
  if (first_event) span.before = std::min(span.before, *first_event - 1);
  return span;
}

/// The contacts open after event `at`, from messages before and after it.
template <class News>
class OpeningContacts {
 public:
  OpeningContacts(const ServerLife& life, std::uint64_t at, nanoseconds begin) : life_(life), at_(at), begin_(begin) {}

  void gather(const TimedMessages<News>& messages) {
    for (const TimedMessage<News>& message : messages) {
      const auto* const shard = std::get_if<HeardShardOf<News>>(&message.heard);
      if (shard != nullptr && shard->from == life_ && shard->shard < shards_.size()) take_shard(*shard);
    }
    for (const HeardShardOf<News>* const shard : shards_) {
      if (shard == nullptr) continue;
      for (const News& contact : shard->contacts) hold(contact);
    }
    for (const HeardShardOf<News>* const shard : later_) {
      for (const News& contact : shard->contacts) hold(contact);
    }
    for (const TimedMessage<News>& message : messages) {
      const auto* const frame = std::get_if<HeardFrameOf<News>>(&message.heard);
      if (frame == nullptr || frame->from != life_) continue;
      for (const auto& entry : frame->entries) {
        if (entry.event.kind == EventKind::ended) take_end(entry.event);
        else if (entry.event.kind == EventKind::contained || entry.event.kind == EventKind::emerged)
          take_containment(entry.event);
      }
    }
  }

  void tell(WatchStateOf<News>& watch, Clock::time_point now) const {
    std::array<HeardShardOf<News>, wire_contract::kContactShards> shards;
    HeardBookmark bookmark{.from = life_,
                           .last_event_sequence = at_,
                           .contact_count = 0,
                           .contact_hash = 0,
                           .world_time = begin_,
                           .settled = true};
    for (const auto& [pair, contact] : held_) {
      shards[wire_contract::contact_shard(pair.first, pair.second)].contacts.push_back(contact);
      bookmark.contact_hash += wire_contract::contact_hash(pair.first, pair.second, contact.episode);
      ++bookmark.contact_count;
    }
    for (std::size_t i = 0; i < shards.size(); ++i) {
      shards[i].from = life_;
      shards[i].shard = static_cast<std::uint8_t>(i);
      shards[i].as_of_sequence = at_;
      watch.hear(shards[i], now);
    }
    watch.hear(bookmark, now);
  }

  std::uint64_t undated() const { return undated_; }

 private:
  void take_shard(const HeardShardOf<News>& shard) {
    if (shard.as_of_sequence > at_) {
      later_.push_back(&shard);
    } else if (const HeardShardOf<News>*& newest = shards_[shard.shard];
               newest == nullptr || newest->as_of_sequence <= shard.as_of_sequence) {
      newest = &shard;
    }
  }

  /// Adds a contact of a later shard, unless it began after `at`.
  News* hold(const News& contact) {
    if (contact.episode > at_) return nullptr;
    const auto [held, is_new] = held_.try_emplace({contact.a_id, contact.b_id}, contact);
    if (!is_new && held->second.episode < contact.episode) held->second = contact;
    return &held->second;
  }

  /// The first change after `at` implies the state before it; a later shard has the state after it.
  void take_containment(const News& change) {
    const auto known = held_.find({change.a_id, change.b_id});
    if (known == held_.end() || known->second.episode != change.episode) return;
    if (!changed_.insert(known->first).second) return;
    known->second.contained = change.kind == EventKind::emerged ? change.contained : Containment::none;
  }

  void take_end(const News& ended) {
    if (ended.episode > at_) return;
    const auto known = held_.find({ended.a_id, ended.b_id});
    if (known == held_.end() || known->second.episode < ended.episode) {
      News* const contact = hold(ended);
      contact->kind = EventKind::open;
      contact->reason = EndReason::none;
      contact->began = contact->world_time = begin_;
      contact->bracket_low_s = contact->bracket_high_s = 0;
      ++undated_;
      return;
    }
    // A shard that is too large for names omits them.
    take_names(ended, known->second);
  }

  ServerLife life_;
  std::uint64_t at_;
  nanoseconds begin_;
  std::array<const HeardShardOf<News>*, wire_contract::kContactShards> shards_{};  // the newest up to the begin
  std::vector<const HeardShardOf<News>*> later_;
  std::map<Pair, News> held_;
  std::set<Pair> changed_;  // open contacts with a known change of containment after `at`
  std::uint64_t undated_ = 0;
};

/// The loaded scenes by the newest readable status.
std::vector<std::string> scenes_of(const RecordedItems& recorded) {
  std::vector<std::string> names;
  dds::Sample<wire::Status> status;
  const auto is_read = [&](const RecordedItem& item) {
    return item.topic == Recorded::status && wire::read_cdr(item.data, status);
  };
  if (std::find_if(recorded.items.rbegin(), recorded.items.rend(), is_read) == recorded.items.rend()) return names;
  std::istringstream lines(status->scenes);
  for (std::string name; std::getline(lines, name);) names.push_back(name);
  return names;
}

template <class News>
const ServerLife& life_of(const TimedMessage<News>& message) {
  return std::visit([](const auto& heard) -> const ServerLife& { return heard.from; }, message.heard);
}

}  // namespace

template <class News>
MissingEvents hear_recording(const RecordedItems& recorded, Names& names, WatchStateOf<News>& watch,
                             const std::function<void(nanoseconds)>& time_is) {
  const TimedMessages<News> messages = messages_of<News>(recorded, names);
  MissingEvents missing;
  if (messages.empty()) return missing;
  std::vector<ServerLife> lives;
  for (const TimedMessage<News>& message : messages) {
    if (std::find(lives.begin(), lives.end(), life_of(message)) == lives.end()) lives.push_back(life_of(message));
  }
  for (const ServerLife& life : lives) missing.lost += span_of_life(life, messages).lost();
  OpeningContacts<News> opening(lives.front(), span_of_life(lives.front(), messages).before, span_of(recorded).begin);
  opening.gather(messages);
  missing.undated = opening.undated();
  opening.tell(watch, Clock::time_point(nanoseconds(messages.front().log_time)));
  for (const TimedMessage<News>& message : messages) {
    const Clock::time_point now{nanoseconds(message.log_time)};
    if (time_is) time_is(nanoseconds(message.log_time));
    std::visit([&](const auto& heard) { watch.hear(heard, now); }, message.heard);
  }
  missing.is_begin_doubtful = missing.lost == 0 && lives.size() == 1 && (watch.resyncs() > 0 || !watch.in_step());
  return missing;
}
template MissingEvents hear_recording(const RecordedItems&, Names&, WatchStateOf<Event>&,
                                      const std::function<void(nanoseconds)>&);
template MissingEvents hear_recording(const RecordedItems&, Names&, WatchStateOf<StandingNews>&,
                                      const std::function<void(nanoseconds)>&);

RecordedSpan span_of(const RecordedItems& recorded) {
  const auto first = std::find_if(recorded.items.begin(), recorded.items.end(),
                                  [](const RecordedItem& item) { return !item.opening; });
  const RecordedItem& begin = first == recorded.items.end() ? recorded.items.front() : *first;
  return {nanoseconds(begin.log_time), nanoseconds(recorded.items.back().log_time)};
}

std::chrono::nanoseconds resolved(const RunTime& time, const RecordedSpan& span) {
  switch (time.since) {
    case RunTime::Since::begin: return span.begin + time.offset;
    case RunTime::Since::end: return span.end + time.offset;
    case RunTime::Since::year_1970: break;
  }
  return time.offset;
}

template <class News>
std::vector<News> in_window(std::vector<News> events, nanoseconds from, nanoseconds to, EventOrder order) {
  using Known = decltype(names_of(std::declval<const News&>()));
  struct Timed {
    nanoseconds at;
    const News* event;
  };
  std::vector<Timed> timed;
  // The newest event of each pair, since a pair's events keep their order regardless of their brackets.
  std::map<Known, nanoseconds> last_of_pair;
  for (const News& event : events) {
    const auto [last, is_first] = last_of_pair.try_emplace(names_of(event), nanoseconds::min());
    if (event.kind != EventKind::open) last->second = std::max(last->second, happened(event));
    timed.push_back({last->second, &event});
  }
  std::stable_sort(timed.begin(), timed.end(), [](const Timed& a, const Timed& b) { return a.at < b.at; });

  std::vector<News> told;
  std::map<Known, const News*> held;
  std::uint64_t sequence = 0;  // of the newest event in the state at `from`, with its life of the server
  std::uint64_t epoch = 0;
  auto next = timed.begin();
  for (; next != timed.end() && (next->event->kind == EventKind::open || next->at < from); ++next) {
    const Known names = names_of(*next->event);
    sequence = std::max(sequence, next->event->sequence);
    epoch = next->event->epoch;
    if (next->event->kind == EventKind::ended) {
      held.erase(names);
    } else {
      held.insert_or_assign(names, next->event);
    }
  }
  const auto end = std::find_if(next, timed.end(), [&](const Timed& one) { return one.at > to; });
  if (order == EventOrder::sequence) {
    // A pair's events keep their order in both orders, so the state at `from` remains the state before the first of
    // them.
    std::sort(next, end, [](const Timed& a, const Timed& b) { return a.event < b.event; });
    for (auto one = next; one != end; ++one) {
      if (one->event->epoch == epoch) sequence = std::min(sequence, one->event->sequence - 1);
    }
  }
  for (const auto& [names, contact] : held) {
    if (contact->kind == EventKind::open && contact->began > to) continue;
    News& open = told.emplace_back(*contact);
    open.kind = EventKind::open;
    open.reason = EndReason::none;
    if (contact->kind == EventKind::emerged) open.contained = Containment::none;
    open.resync = true;
    open.sequence = sequence;
  }
  std::stable_sort(told.begin(), told.end(), [](const News& a, const News& b) { return a.began < b.began; });
  for (; next != end; ++next) told.push_back(*next->event);
  return told;
}
template std::vector<Event> in_window(std::vector<Event>, nanoseconds, nanoseconds, EventOrder);
template std::vector<StandingNews> in_window(std::vector<StandingNews>, nanoseconds, nanoseconds, EventOrder);

}  // namespace client

Result<RecordedEvents> recorded_events(const std::string& path, const RecordedEventsOptions& options) try {
  const client::RecordedItems recorded = client::read_items(client::read_recording(path), path, "Nothing was read");
  const client::RecordedSpan span = client::span_of(recorded);
  const auto from = options.from ? client::resolved(*options.from, span) : std::chrono::nanoseconds::min();
  const auto to = options.to ? client::resolved(*options.to, span) : std::chrono::nanoseconds::max();
  if (from > to) return client::bad_input("the end of what is asked for lies before its begin", "nothing was read");
  std::vector<Event> events;
  client::Names names;
  client::WatchState watch([&](const Event& event) {
    if (client::is_wanted(event, options.only, options.skip)) events.push_back(event);
  });
  const client::MissingEvents missing = client::hear_recording(recorded, names, watch);
  RecordedEvents told{.events = client::in_window(std::move(events), from, to, client::EventOrder::happened),
                      .begin = span.begin,
                      .end = span.end,
                      .scenes = client::scenes_of(recorded),
                      .lost = missing.lost,
                      .warnings = recorded.warnings};
  const auto warn = [&](const std::string& what) { told.warnings.push_back(path + ": " + what); };
  if (missing.lost > 0)
    warn(std::to_string(missing.lost) + " events are not in it; what they changed is marked resync as far as it shows");
  if (missing.undated > 0)
    warn("of " + std::to_string(missing.undated) +
         " contacts it tells the end but not since when they held: at least from its begin");
  if (missing.is_begin_doubtful) warn("it does not tell of every contact that held at its begin");
  return told;
} catch (const std::runtime_error& failed) { return client::bad_input(failed.what(), ""); }

}  // namespace collided
