#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "idl/columns.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/clock.hpp"

// Decides which questions Answering takes into its queue, and how it answers those that it does not take.

namespace collided::engine::service {

using wire_contract::Importance;
using wire_contract::QuestionKind;

void Answering::admit(AskPointer ask) {
  const wire::Query& query = *ask->query;
  if (query.chunk_count <= 1 || query.chunk_index >= query.chunk_count) return enqueue(std::move(ask));
  // A request is refused whole, before any work is done on it.
  if (query.chunk_index == 0) {
    if (leaves_out(query)) return refuse_as_left_out(std::move(ask));
    if (!queue_.has_room_for(share_of(*ask))) return refuse_for_now(std::move(ask));
  }
  switch (with_.leases.take(ask, least_version(query), steady_ns())) {
    case SnapshotLeases::Taken::pinned: return enqueue(std::move(ask));
    case SnapshotLeases::Taken::waits: return;
    case SnapshotLeases::Taken::gone:
      return refuse_later(std::move(ask),
                          "the state that this request is answered on is no longer kept: the first chunk comes first, "
                          "and others that wait for a state do so for 2 s at most while none of its chunks is here",
                          retry_after_ns());  // a repeated request gets another state
    case SnapshotLeases::Taken::full: return refuse_for_now(std::move(ask));
  }
}

Share Answering::share_of(const Ask& ask) {
  const wire::Query& query = *ask.query;
  const bool is_question = wire_contract::numbers_of(static_cast<QuestionKind>(query.kind)) > 0;
  return {.client = query.client,
          .owner = ask.from.participant,
          .cost = cost_of(query),
          .bytes = wire::bytes_of(query),
          .is_kept = !is_question || static_cast<Importance>(query.importance) == Importance::high,
          .is_begun = static_cast<bool>(ask.hold)};
}

/// Queues a question, or refuses it if its client has too many there already. Commands, hellos and questions of high
/// importance may fill more of the queue than others (Share::is_kept).
void Answering::enqueue(AskPointer ask) {
  if (!ask->hold && leaves_out(*ask->query)) return refuse_as_left_out(std::move(ask));
  const Share share = share_of(*ask);
  Work work(std::move(ask));
  if (queue_.push(share, work)) return;
  refuse_for_now(std::move(std::get<AskPointer>(work)));
}

/// Puts back a chunk that has had its turn, so that waiting ones get theirs; false: none waits.
bool Answering::put_back(AskPointer& ask) {
  if (stopping_.load()) return false;
  if (queue_.waiting() == 0 && !queue_.has_own()) return false;
  Share share = share_of(*ask);
  share.cost = static_cast<double>(kTurnNs) / kNsPerCostAtFirst;
  share.is_begun = true;
  Work work(std::move(ask));
  if (queue_.push(share, work)) return true;
  ask = std::move(std::get<AskPointer>(work));
  return false;
}

/// Passes a chunk on to the threads for costly questions, or back to them if it was there; `took_ns` is its last turn.
/// False: it continues here, since no other costly chunk waits, or there is no room for a chunk that has begun.
bool Answering::put_among_costly(AskPointer& ask, std::int64_t took_ns, bool was_there) {
  if (stopping_.load() || (was_there && costly_.waiting() == 0)) return false;
  Share share = share_of(*ask);
  const bool is_begun = share.is_begun || ask->answered > 0;
  share.cost = static_cast<double>(std::max(took_ns, kTurnNs));
  share.is_begun = was_there;  // its room there is reserved
  if (costly_.push(share, ask)) return true;
  if (is_begun) return false;
  const double wait_ns = costly_.waiting_cost() / static_cast<double>(costly_.most_threads());
  refuse_later(std::move(ask),
               fmt::format("there is no room for it now: {} requests that take long wait already", costly_.waiting()),
               static_cast<std::int64_t>(std::min(wait_ns, 5e9)));
  return true;
}

void Answering::refuse_as_left_out(AskPointer ask) {
  refuse_later(std::move(ask), "overloaded: questions of the low class are refused until the rest is dealt with");
}

/// Refuses for lack of room, and estimates when there will be some.
void Answering::refuse_for_now(AskPointer ask) {
  refuse_later(std::move(ask),
               fmt::format("there is no room for it now: {} requests of {:.1f} MB wait already", queue_.waiting(),
                           static_cast<double>(queue_.waiting_bytes()) / 1e6),
               retry_after_ns());
}

/// A moving mean over about sixteen questions.
void Answering::note_cost(double cost, std::int64_t took_ns) {
  const double before = ns_per_cost_.load(std::memory_order_relaxed);
  ns_per_cost_.store(before + (static_cast<double>(took_ns) / cost - before) / 16, std::memory_order_relaxed);
}

/// The estimated time in which the workers finish half of the queue.
std::int64_t Answering::retry_after_ns() {
  constexpr double kLeastNs = 10e6;
  constexpr double kMostNs = 5e9;
  const double all_ns = queue_.waiting_cost() * ns_per_cost_.load(std::memory_order_relaxed);
  const double threads = static_cast<double>(queue_.most_threads());
  return static_cast<std::int64_t>(std::clamp(all_ns / threads / 2, kLeastNs, kMostNs));
}

/// Whether this question is refused because of overload: only those of low importance are.
bool Answering::leaves_out(const wire::Query& query) const {
  return options_.overload != nullptr && options_.overload->refuses_low_questions() &&
         wire_contract::numbers_of(static_cast<QuestionKind>(query.kind)) > 0 &&
         static_cast<Importance>(query.importance) == Importance::low;
}

bool Answering::was_pressed() {
  const std::uint64_t refused = queue_.refused() + costly_.refused();
  const bool turned_away = refused != std::exchange(refused_before_, refused);
  return turned_away || queue_.waiting() > kMostQueued / 2;
}

/// The oldest state that may answer. A client never gets an older state than before; after a write barrier it gets the
/// newest.
std::uint64_t Answering::least_version(const wire::Query& query) const {
  if (query.barrier_publisher != 0) return std::numeric_limits<std::uint64_t>::max();
  const std::shared_ptr<Client> client = clients_.find(query.client);
  return client ? client->reported_version() : 0;
}

void Answering::refuse_later(AskPointer ask, std::string reason, std::int64_t retry_after_ns) {
  // A client that asks faster than refusals can be written gets none.
  if (!queue_.has_room_for_own()) {
    ++with_.counts.unanswerable;
    pool_.put(std::move(ask));
    return;
  }
  ask->refusal = std::move(reason);
  ask->retry_after_ns = retry_after_ns;
  // The questions are not needed any more, and thousands of refusals may wait.
  wire::clear_questions(*ask->query);
  dds::borrow(ask->query->blob, std::span<const std::uint8_t>());
  queue_.push_own(std::move(ask));
}

}  // namespace collided::engine::service
