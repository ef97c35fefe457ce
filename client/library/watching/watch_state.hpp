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

/// An event of a server, by its number.
struct EventPlace {
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
};

/// How one run of a server was heard to follow another.
struct LifeChange {
  std::uint64_t changes = 0;  // how many there were, this one included; 0: there was none
  ServerLife before;
  ServerLife now;
  /// The number of the first event of `now` that was heard or, where no event was, would have been, by the first bookmark.
  std::uint64_t heard_from = 0;
};

/// By which what holds is known in every life of a server. Of contacts: the two names sorted, since the ids, and with them the
/// order of the two, change when an object is defined anew.
std::pair<std::string, std::string> names_of(const Event& event);
/// The same of all that cannot hold at a time.
inline auto place_of(const Event& event) { return names_of(event); }
void take_names(const Event& from, Event& to);

/// A frame of events, each of kind began or ended; on the topic of contacts that go on, persisted. Event i has the
/// sequence number first_sequence + i, but those that are joined have one together.
template <class News>
struct HeardFrameOf {
  ServerLife from;
  std::uint64_t first_sequence = 0;
  struct Entry {
    News event;
    std::uint8_t shard = 0;
    bool joins_next = false;  // the next entry is a part of the same event; of standing questions
  };
  std::vector<Entry> entries;
  bool is_again = false;  // a server whose place the sender has taken may have told them

  std::size_t event_count() const {
    return static_cast<std::size_t>(std::ranges::count(entries, false, &Entry::joins_next));
  }
};
using HeardFrame = HeardFrameOf<Event>;

/// The contacts of one shard that held after event `as_of_sequence`, as events of kind `open`.
template <class News>
struct HeardShardOf {
  ServerLife from;
  std::uint8_t shard = 0;
  std::uint64_t as_of_sequence = 0;
  std::vector<News> contacts;
};
using HeardShard = HeardShardOf<Event>;

/// The bookmark in a status, or in the sum of standing questions: how many contacts hold after event `last_event_sequence`,
/// and their hash.
struct HeardBookmark {
  ServerLife from;
  std::uint64_t last_event_sequence = 0;
  std::uint32_t contact_count = 0;
  std::uint64_t contact_hash = 0;
  std::chrono::nanoseconds world_time{0};
  bool settled = true;  // false while a restarted server waits for its publishers
};

/// Turns a server's messages (frames of events, shards of the contact state, bookmarks) into events, each once and in
/// order, whatever is lost on the way. It uses no DDS, threads or clocks; the caller passes the time.
///
/// While in step, each event's number is one more than the last. A gap, a bookmark that disagrees or a new life of the
/// server makes it doubtful. Then events are still emitted, with those that they imply were missed, until shards and
/// events together give a state whose count and hash match a bookmark; the differences to that state follow, marked
/// `resync`.
///
/// All of this applies to what holds of standing questions (StandingNews) as it does to contacts; only contacts may be
/// contained.
///
/// threads  one at a time
/// Always: for every pair of ids, and for every pair of names, it emits `began` (or `open`) and `ended` in turn, and
/// between them `contained` and `emerged` in turn; an `open` may begin contained.
template <class News>
class WatchStateOf {
 public:
  using Emit = std::function<void(const News&)>;
  explicit WatchStateOf(Emit emit) : emit_(std::move(emit)) {}

  void hear(const HeardFrameOf<News>& frame, Clock::time_point now);
  void hear(const HeardShardOf<News>& shard, Clock::time_point now);
  void hear(const HeardBookmark& bookmark, Clock::time_point now);
  /// Takes contacts that go on, whose topic is not numbered. Those of contacts that were reported are emitted.
  void hear_persisted(const HeardFrameOf<News>& frame);

  bool in_step() const { return mode_ == Mode::in_step; }
  /// Up to which event, of which epoch, everything has been emitted; nothing while it is not in step.
  std::optional<EventPlace> emitted_through() const {
    return in_step() ? std::optional(EventPlace{life_->epoch, applied_}) : std::nullopt;
  }
  std::uint64_t resyncs() const { return resyncs_; }
  /// How often something was missed within the life of a server, or was found to be missing in the next one's.
  std::uint64_t gaps() const { return gaps_; }
  /// The newest; heard_from may become less until all events of a bookmark have come.
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
  void doubt();

  /// What a server told last of a pair.
  struct Told {
    std::chrono::nanoseconds time{0};  // happened() of it
    unsigned kinds = 0;                // bit by EventKind, of what was told at that time
  };
  void note_told(const News& event);
  /// Whether the event was told in the life before: a server that takes another one's place tells again what its
  /// predecessor may not have told any more.
  /// last      of its parts: the beginning of a crossing is as old as its end
  /// is_again  as of its frame; else only the very event is meant, which that server has worked out after it took the place
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
  /// Ends what cannot hold beside it.
  void end_namesake(News& event);
  bool is_carried(const News& event) const;
  /// Takes a contact from an earlier life of the server over into this one; false where none has these names.
  /// tells_containment  tells also what the event says of who lies within whom, as missed
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
  bool has_gap_ = false;  // that is in gaps_, and not made up for yet
  LifeChange life_change_;
  std::optional<ServerLife> life_;
  Clock::time_point last_heard_;

  std::uint64_t applied_ = 0;            // number of the newest event heard
  std::uint64_t run_start_ = 0;          // events from here to applied_ came without a gap; 0: none has come yet
  Contacts held_;                        // contacts that were reported and have not ended
  std::map<Names, Pair> held_by_place_;  // by place_of(), as carried_
  std::map<Names, News> carried_;        // reported in an earlier life of the server, not yet seen in this one
  std::map<Names, Told> told_;           // in the life before; emptied once nothing of that time can come any more
  std::chrono::nanoseconds told_to_{0};  // the newest world time of that life; 0: there was none, or it is long over
  std::chrono::nanoseconds joined_{0};   // world time of the state that was adopted first

  std::array<Shard, wire_contract::kContactShards> shards_;
  std::deque<Entry> recent_;
  std::optional<HeardBookmark> bookmark_;
  std::optional<std::uint64_t> behind_at_;  // applied_ when a bookmark was first ahead of it
  bool stuck_ = false;  // at the next bookmark applied_ was still the same: the missing events will not come
};
using WatchState = WatchStateOf<Event>;

}  // namespace collided::client
