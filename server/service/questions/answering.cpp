#include "server/service/questions/answering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <tuple>
#include <nlohmann/json.hpp>

#include "server/service/questions/answering_worker.hpp"

namespace collided::engine::service {

using wire_contract::QuestionKind;
using wire_contract::ReplyStatus;

std::string refusal_text(const std::string& error, const std::string& hint, std::int64_t retry_after_ns) {
  nlohmann::json text{{"error", error}};
  if (!hint.empty()) text["hint"] = hint;
  if (retry_after_ns > 0) text["retry_after_ms"] = std::max<std::int64_t>(1, retry_after_ns / 1'000'000);
  return text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
Answering::Answering(const Collaborators& with, const dds::Topic<wire::Reply>& replies, const AnsweringOptions& options,
                     Command command)
    : with_(with),
      past_states_(with.world, with.place),
      options_(options),
      epoch_(options.epoch),
      command_(std::move(command)),
      queue_(kMostQueued, kMostQueuedBytes),
      costly_(kMostQueued, kMostQueuedBytes),
      clients_(replies, [this](std::uint32_t place) { queue_.push_own(Resume{place}); }),
      participants_(options.peers),
      ns_per_cost_(kNsPerCostAtFirst) {
  with_.leases.on_ready([this](AskPointer ask) { enqueue(std::move(ask)); });
  listening_worker_ = std::make_unique<Worker>(*this, kListeningNs);
  const std::size_t threads = std::max(1U, options.threads);
  queue_.staff(threads, [this] { return [worker = std::make_shared<Worker>(*this, kQuestionNs)] { worker->run(); }; });
  costly_.staff(std::min(threads, kMostCostlyThreads),
                [this] { return [worker = std::make_shared<Worker>(*this, 0)] { worker->run_costly(); }; });
}

Answering::~Answering() {
  stop();
  // Asks left in the queue release their states, and a release passes on waiting chunks: drop those after the stop.
  with_.leases.on_ready([](AskPointer) {});
}

void Answering::listen(const dds::Taker<wire::Query>& taker) {
  AskPointer single;
  take(taker, &single);
  if (!single) return;
  const wire::Query& query = *single->query;
  const std::int64_t started_ns = single->taken_ns;
  Client* client = nullptr;
  if (short_questions_.is_short(query, started_ns) && !leaves_out(query)) {
    client = clients_.find_ready(query.client, single->owner);
  }
  if (!client) {
    enqueue(std::move(single));
    return;
  }
  const bool is_answered = listening_worker_->answer(*client, *single);
  short_questions_.took(started_ns, steady_ns());
  if (!is_answered) return enqueue(std::move(single));
  single->reset();
  spare_ = std::move(single);
}

/// Takes as much as the queue has room for. The first single question goes to `single`, if that is not null. One thread
/// takes at a time: another that arrives meanwhile raises the count, and the first one repeats its round.
void Answering::take(const dds::Taker<wire::Query>& taker, AskPointer* single) {
  if (takers_.fetch_add(1) > 0) return;
  std::uint32_t seen = 1;
  do { drain(taker, single); } while (!takers_.compare_exchange_strong(seen, 0));
}

void Answering::drain(const dds::Taker<wire::Query>& taker, AskPointer* single) {
  while (!stopping_.load() && !holds_.load() && queue_.has_room()) {
    std::array<dds::Sample<wire::Query>*, std::tuple_size_v<decltype(next_)>> room{};
    for (std::size_t i = 0; i < room.size(); ++i) {
      if (!next_[i]) next_[i] = single && spare_ ? std::move(spare_) : pool_.get();
      room[i] = &next_[i]->query;
    }
    const std::size_t count = taker.take(room);
    const std::int64_t now_ns = steady_ns();
    for (std::size_t i = 0; i < count; ++i) {
      if (!next_[i]->query.info().valid_data) continue;
      next_[i]->taken_ns = now_ns;
      const std::uint64_t writer = next_[i]->query.info().publication_handle;
      next_[i]->from = participants_.of(taker.reader(), writer);
      next_[i]->owner = options_.peers == nullptr ? writer : next_[i]->from.participant;
      if (options_.flight) {
        options_.flight->note(recording::Recorded::query, *next_[i]->query, next_[i]->query.info().source_timestamp);
      }
      route(std::move(next_[i]), single);
    }
    if (count < room.size()) return;
  }
  // The rest stays with DDS, which makes the clients wait, until a worker or go_on() comes back for it.
  if (stopping_.load()) return;
  left_in_reader_.store(taker.reader());
  // Room or go_on() may have come before this was noted, and found nothing to come back for; then take() runs again.
  const bool may_take = !holds_.load() && queue_.has_room();
  if (may_take && left_in_reader_.exchange(0) != 0) takers_.fetch_add(1);
}

/// What the sender's keys do not allow; null: nothing. Which right a command needs is known once it is read.
const char* Answering::why_not_allowed(const Ask& ask) const {
  if (options_.peers == nullptr) return nullptr;
  const wire::Query& query = *ask.query;
  const auto kind = static_cast<QuestionKind>(query.kind);
  if (kind == QuestionKind::hello || kind == QuestionKind::command) return nullptr;
  if (!ask.from.has(wire_contract::QueryRight::ask)) return "the keys give no right to ask questions";
  if (static_cast<wire_contract::Importance>(query.importance) == wire_contract::Importance::high &&
      !ask.from.peer->asks_high)
    return "the keys give no right to questions of high importance; role admin has it";
  return nullptr;
}

/// Why this server does not answer now; null: it answers.
const char* Answering::why_not_answered(const wire::Query& query) const {
  if (static_cast<QuestionKind>(query.kind) == QuestionKind::hello || with_.place.whole_since_ns()) return nullptr;
  return "this replica's world was not found the primary's of late; the primary answers, "
         "and collide fleet shows both";
}

void Answering::route(AskPointer ask, AskPointer* single) {
  // With keys, a sender that has proved nothing or is already gone has no rights and gets no answer.
  if (ask->from.rights == 0) {
    ++with_.counts.unanswerable;
    return pool_.put(std::move(ask));
  }
  if (const char* reason = why_not_allowed(*ask)) return refuse_later(std::move(ask), reason);
  if (const char* reason = why_not_answered(*ask->query)) return refuse_later(std::move(ask), reason);
  const WriteBarriers::Outcome outcome = with_.write_barriers.pass(ask);
  if (outcome == WriteBarriers::Outcome::parked) return;
  if (outcome == WriteBarriers::Outcome::full) {
    refuse_later(
        std::move(ask),
        fmt::format("too many questions wait for a publisher's samples: at most {} in all, {} of one process, "
                    "the last {} for processes with fewer than {}",
                    WriteBarriers::kMost, WriteBarriers::kMostOfOne, WriteBarriers::kReserved, WriteBarriers::kFew));
  } else if (single && !*single && is_single(*ask->query)) {
    *single = std::move(ask);
  } else {
    admit(std::move(ask));
  }
}

void Answering::go_on() {
  holds_.store(false);
  take_more();
}

void Answering::take_more() {
  const dds_entity_t reader = left_in_reader_.exchange(0);
  if (reader != 0) take(dds::Taker<wire::Query>(reader), nullptr);
}

void Answering::send_text(std::uint64_t client, std::uint64_t request, ReplyStatus status, std::string text,
                          bool is_recorded) {
  if (status == ReplyStatus::refused) ++with_.counts.refused;
  queue_.push_own(TextReply{client, request, status, std::move(text), is_recorded});
}

void Answering::tick(std::vector<std::uint64_t> query_owners) {
  const std::int64_t now_ns = steady_ns();
  with_.leases.expire(now_ns);
  for (AskPointer& ask : with_.write_barriers.take_overdue(now_ns)) {
    const wire::Query& query = *ask->query;
    const std::uint64_t applied = with_.write_barriers.applied(query.barrier_publisher);
    refuse_later(std::move(ask),
                 applied == 0
                     ? fmt::format("publisher {:016x} is not known here, so its sample {} could not be waited for",
                                   query.barrier_publisher, query.barrier_sequence)
                     : fmt::format("sample {} of publisher {:016x} did not come in time; applied: {}",
                                   query.barrier_sequence, query.barrier_publisher, applied));
  }
  if (clients_.size() > 0) queue_.push_own(ExpireLeases{std::move(query_owners)});
}

void Answering::stop() {
  if (stopping_.exchange(true)) return;
  stops_by_ns_.store(steady_ns() + kStopPatienceNs);
  for (AskPointer& ask : with_.write_barriers.take_all()) refuse_later(std::move(ask), "the server is stopping");
  for (AskPointer& ask : with_.leases.take_waiting()) refuse_later(std::move(ask), "the server is stopping");
  // Clients in the middle of a longer question are notified that the server stops.
  std::promise<void> ended;
  std::thread patience([this, in_time = ended.get_future()] {
    const auto until = std::chrono::steady_clock::time_point(std::chrono::nanoseconds(stops_by_ns_.load()));
    if (in_time.wait_until(until) == std::future_status::timeout) clients_.call_off_all();
  });
  queue_.finish();
  costly_.finish();  // only now: the workers still pass asks to it
  ended.set_value();
  patience.join();
}

}  // namespace collided::engine::service
