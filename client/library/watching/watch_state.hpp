#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/library/connection/server_pulse.hpp"
#include "collided/client.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// One run of a server, from start to end. Ids and sequence numbers are valid within it.
struct ServerLife {
  std::uint64_t server = 0;
  std::uint64_t epoch = 0;
  bool operator==(const ServerLife&) const = default;
};

/// How one run of a server was heard to follow another.
struct LifeChange {
  std::uint64_t changes = 0;  // number of transitions, including this one; 0: none
  ServerLife before;
  ServerLife now;
  /// Number of the first received event of `now` or, before any event, of the next one after the first bookmark.
  std::uint64_t heard_from = 0;
};

/// The key of a contact that is valid in every life of a server: the two names, sorted. Ids, and with them the order of
/// the two, change when an object is redefined.
std::pair<std::string, std::string> names_of(const Event& event);
/// The key shared by mutually exclusive states.
inline auto place_of(const Event& event) { return names_of(event); }
void take_names(const Event& from, Event& to);

/// Up to which world time a server has decided, where all its events until then have been emitted.
struct SettledTime {
  std::chrono::nanoseconds to{0};
  Clock::time_point came;  // the newest watermark
  ServerLife life;
  std::uint64_t heir_of = 0;    // the server whose place that one has taken; 0: none
  std::uint64_t told_from = 0;  // the number of its first event since then
};

/// A frame of events, each of kind began or ended; on the topic of contacts that go on, persisted. Event i has the
/// sequence number first_sequence + i, but those that are joined have one together.
template <class News>
struct HeardFrameOf {
  ServerLife from;
  std::uint64_t first_sequence = 0;
  struct Entry {
    News event;
    std::uint8_t shard = 0;
    bool joins_next = false;  // the next entry is a part of the same event; for standing questions
  };
  std::vector<Entry> entries;
  bool is_again = false;                   // a server whose place the sender has taken may have told them
  std::chrono::nanoseconds settled_to{0};  // watermark: no later event is older; 0: none

  std::size_t event_count() const {
    return static_cast<std::size_t>(std::ranges::count(entries, false, &Entry::joins_next));
  }
};
using HeardFrame = HeardFrameOf<Event>;

/// The contacts of one shard that were open after event `as_of_sequence`, as events of kind `open`.
template <class News>
struct HeardShardOf {
  ServerLife from;
  std::uint8_t shard = 0;
  std::uint64_t as_of_sequence = 0;
  std::vector<News> contacts;
};
using HeardShard = HeardShardOf<Event>;

/// The bookmark in a status, or in the sum of standing questions: number and hash of the contacts open after event
/// `last_event_sequence`.
struct HeardBookmark {
  ServerLife from;
  std::uint64_t last_event_sequence = 0;
  std::uint32_t contact_count = 0;
  std::uint64_t contact_hash = 0;
  std::chrono::nanoseconds world_time{0};
  bool settled = true;                     // false while a restarted server waits for its publishers
  std::chrono::nanoseconds settled_to{0};  // watermark, as in a frame
  std::uint64_t heir_of = 0;               // as in SettledTime
  std::uint64_t told_from = 0;
};

/// Turns a server's messages (frames of events, shards of the contact state, bookmarks) into events, each once and in
/// order, despite lost messages. It uses no DDS, threads or clocks; the caller passes the time.
///
/// While in step, each event's number is one more than the last. A gap, a contradicting bookmark or a new life of the
/// server makes the state doubtful. Then events are still emitted, together with the missed events that they imply. As
/// soon as shards and events give a state whose count and hash match a bookmark, the differences to that state follow,
/// marked `resync`.
///
/// All of this also applies to states of standing questions (StandingNews); only contacts may be contained.
///
/// threads  one at a time
/// Invariant: for every pair of ids, and for every pair of names, it emits `began` (or `open`) and `ended` alternately,
/// and between them `contained` and `emerged` alternately; an `open` may begin contained.
template <class News>
class WatchStateOf {
 public:
  using Emit = std::function<void(const News&)>;
  explicit WatchStateOf(Emit emit) : emit_(std::move(emit)) {}

  void hear(const HeardFrameOf<News>& frame, Clock::time_point now);
  void hear(const HeardShardOf<News>& shard, Clock::time_point now);
  void hear(const HeardBookmark& bookmark, Clock::time_point now);
  /// Takes persisting contacts, whose topic is not numbered. It emits those of reported contacts.
  void hear_persisted(const HeardFrameOf<News>& frame);

  bool in_step() const { return mode_ == Mode::in_step; }
  /// Nothing while it is not in step, or has no watermark of the server's present life.
  std::optional<SettledTime> settled() const {
    return in_step() && settled_.to.count() != 0 ? std::optional(settled_) : std::nullopt;
  }
  std::uint64_t resyncs() const { return resyncs_; }
  /// Number of gaps within the life of a server, or found in the next life.
  std::uint64_t gaps() const { return gaps_; }
  /// The newest transition; heard_from may decrease until all events of a bookmark have come.
  const LifeChange& life_change() const { return life_change_; }

 private:
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  using Contacts = std::map<Pair, News>;
  using Held = typename Contacts::iterator;
  using Names = decltype(names_of(std::declval<const News&>()));
  using Entry = typename HeardFrameOf<News>::Entry;
  enum class Mode { starting, in_step, doubtful };
  struct Shard {
    std::uint64_t as_of_sequence = 0;
    std::vector<News> contacts;
  };

  bool is_current(const ServerLife& from, Clock::time_point now);
  void start_life(const ServerLife& life);
  void note_heard_from(std::uint64_t sequence);
  void note_gap();
  void note_settled(std::chrono::nanoseconds to, std::uint64_t through, Clock::time_point now);
  void doubt();

  /// The last reported changes of a pair.
  struct Told {
    std::chrono::nanoseconds time{0};  // happened() of it
    unsigned kinds = 0;                // bits by EventKind of the changes at that time
  };
  void note_told(const News& event);
  /// True if the event was reported in the previous life: after a failover a server repeats events that its predecessor
  /// may not have published.
  /// last      its last part: the beginning of a crossing has the time of its end
  /// is_again  that of its frame; false: the server derived the event after the failover, so only an identical event
  ///           counts
  bool was_told(const News& event, const News& last, bool is_again) const;
  bool has_ended_before(const News& contact) const;

  void apply(const News& event);
  void apply_began(const News& event);
  void apply_ended(const News& event);
  void apply_containment(const News& event);
  Held begin_missed(const News& event);
  void change_missed(News& held, const News& news, std::uint64_t sequence);
  void hold(const News& contact);
  Held release(Held held);
  /// Ends the state that `event` excludes.
  void end_namesake(News& event);
  bool is_carried(const News& event) const;
  /// Moves a contact from an earlier life of the server into this one; false if none has these names.
  /// tells_containment  also emits a missed change of containment
  bool carry_over(const News& event, bool tells_containment = true);
  void emit_missed(const News& contact, EventKind what, EndReason why, std::uint64_t sequence);
  void note(const Entry& entry);

  void try_adopt();
  bool may_adopt() const;
  bool bookmark_vouches() const;
  Contacts state_at(std::uint64_t sequence) const;
  void adopt_first();
  void adopt_differences();
  void end_carried();

  Emit emit_;
  Mode mode_ = Mode::starting;
  std::uint64_t resyncs_ = 0;
  std::uint64_t gaps_ = 0;
  bool has_gap_ = false;  // counted in gaps_, and not resolved yet
  LifeChange life_change_;
  SettledTime settled_;
  std::optional<ServerLife> life_;
  Clock::time_point last_heard_;

  std::uint64_t applied_ = 0;            // number of the newest received event
  std::uint64_t run_start_ = 0;          // events from here to applied_ came without a gap; 0: no event yet
  Contacts held_;                        // reported contacts that have not ended
  std::map<Names, Pair> held_by_place_;  // by place_of(), like carried_
  std::map<Names, News> carried_;        // reported in an earlier life of the server, not yet seen in this one
  std::map<Names, Told> told_;           // in the previous life; cleared when repetitions can no longer come
  std::chrono::nanoseconds told_to_{0};  // the newest world time of that life; 0: none, or long ago
  std::chrono::nanoseconds joined_{0};   // world time of the state adopted first

  std::array<Shard, wire_contract::kContactShards> shards_;
  std::deque<Entry> recent_;
  std::optional<HeardBookmark> bookmark_;
  std::optional<std::uint64_t> behind_at_;  // applied_ when a bookmark was first ahead of it
  bool stuck_ = false;  // at the next bookmark applied_ was still the same: the missing events will not come
};
using WatchState = WatchStateOf<Event>;

}  // namespace collided::client
