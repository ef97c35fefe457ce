#include "server/service/questions/answering_worker.hpp"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <new>

#include "idl/columns.hpp"
#include "idl/commands.hpp"
#include "server/geometry/endless.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/questions/time_slice.hpp"
#include "server/service/questions/what_if_question.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/covered.hpp"

namespace collided::engine::service {

using wire_contract::QuestionKind;
using wire_contract::ReplyStatus;

namespace {
wire_contract::AskedInstant instant_of(const wire::Query& query) {
  return {.kind = static_cast<wire_contract::AskedInstant::Kind>(query.instant), .ns = query.instant_ns};
}
}  // namespace

void Answering::Worker::run() {
  pthread_setname_np(pthread_self(), "answer");
  // Short single questions are answered on the listener's thread; those that arrive here take long or can wait.
  set_time_slice(kLongSlice);
  while (std::optional<Work> item = owner_.queue_.pop()) {
    try {
      std::visit([this](auto&& one) { work(std::forward<decltype(one)>(one)); }, std::move(*item));
    } catch (const std::bad_alloc&) { ++owner_.with_.counts.unanswerable; }
    if (owner_.left_in_reader_.load(std::memory_order_relaxed) != 0) owner_.take_more();
  }
}

void Answering::Worker::run_costly() {
  pthread_setname_np(pthread_self(), "answer costly");
  set_time_slice(kLongestSlice);
  while (std::optional<AskPointer> ask = owner_.costly_.pop()) {
    try {
      work(std::move(*ask));
    } catch (const std::bad_alloc&) { ++owner_.with_.counts.unanswerable; }
  }
}

void Answering::Worker::work(AskPointer ask) {
  // A client that disconnected while its request was in progress is not registered again.
  const std::uint64_t id = ask->query->client;
  const std::shared_ptr<Client> client = ask->answered > 0 || ask->is_costly || ask->is_part
                                             ? owner_.clients_.find(id)
                                             : owner_.clients_.meet(id, ask->owner, ask->from.participant);
  if (!client) {
    ++owner_.with_.counts.unanswerable;
    owner_.pool_.put(std::move(ask));
    return;
  }
  if (owner_.clients_.hold(*client, ask)) {
    if (!ask) return;
    ++owner_.with_.counts.unanswerable;
    return owner_.pool_.put(std::move(ask));
  }
  if (owner_.is_over()) ask->refusal = "the server is stopping";
  while (true) {
    owner_.share(*ask);
    const double chunk = std::max(1U, wire::question_count(*ask->query).value_or(1));
    const std::size_t before = ask->answered;
    const std::int64_t started_ns = steady_ns();
    const bool is_done = answer(*client, *ask);
    const std::int64_t took_ns = steady_ns() - started_ns;
    const double part =
        is_done ? 1 - static_cast<double>(before) / chunk : static_cast<double>(ask->answered - before) / chunk;
    if (part > 0) owner_.note_cost(cost_of(*ask->query) * part, took_ns);
    if (is_done) break;
    if (client->called_off().load() && !owner_.is_over()) {
      ++owner_.with_.counts.unanswerable;
      break;
    }
    ask->is_costly = ask->is_costly || ask->answered == before;
    if (ask->is_costly ? owner_.put_among_costly(ask, took_ns, patience_ns_ == 0) : owner_.put_back(ask)) return;
    if (owner_.is_over()) ask->refusal = "the server is stopping";
  }
  owner_.pool_.put(std::move(ask));
}

bool Answering::Worker::answer(Client& client, Ask& ask) {
  is_paused_ = false;
  try {
    answer_or_throw(client, ask);
  } catch (const std::bad_alloc&) {
    // All memory allocated so far belongs to this question alone, so nothing is left half changed.
    ++owner_.with_.counts.refused;
    is_paused_ = false;
    write_text(client, ask.query->request, ReplyStatus::refused, out_of_memory_);
  }
  return !is_paused_;
}

void Answering::Worker::answer_or_throw(Client& client, Ask& ask) {
  const wire::Query& query = *ask.query;
  std::optional<std::string> refusal = ask.refusal.empty() ? why_refused(query) : std::optional(ask.refusal);
  if (refusal) {
    ++owner_.with_.counts.refused;
    write_text(client, query.request, ReplyStatus::refused, refusal_text(*refusal, {}, ask.retry_after_ns));
  } else if (query.kind == static_cast<std::uint8_t>(QuestionKind::command)) {
    command(ask);
  } else if (query.kind == static_cast<std::uint8_t>(QuestionKind::hello)) {
    write_text(client, query.request, ReplyStatus::ok, {});
  } else if (query.kind == static_cast<std::uint8_t>(QuestionKind::sweep)) {
    answer_sweeps(client, ask);
  } else if (query.kind == static_cast<std::uint8_t>(QuestionKind::what_if)) {
    answer_configurations(client, ask);
  } else {
    answer_questions(client, ask, nullptr);
  }
}

/// The moving shape comes from the client with the questions, so it is checked here.
void Answering::Worker::answer_sweeps(Client& client, Ask& ask) {
  const wire::Query& query = *ask.query;
  const DecodedShape decoded = decode_shape(std::as_bytes(dds::view(query.blob)));
  std::string refusal = decoded.refusal;
  if (decoded.shape && is_endless(*decoded.shape)) {
    refusal = "a half-space has no end and cannot be moved; every other shape can. Nothing was asked";
  }
  if (!refusal.empty()) {
    ++owner_.with_.counts.refused;
    write_text(client, query.request, ReplyStatus::refused, refusal_text("sweep: " + refusal));
    return;
  }
  const ObjectInfo mover = without_world(*decoded.shape);
  answer_questions(client, ask, &mover);
}

void Answering::Worker::command(const Ask& ask) {
  const wire::Query& query = *ask.query;
  const auto blob = std::as_bytes(dds::view(query.blob));
  owner_.command_({query.client, query.request, query.text, {blob.begin(), blob.end()}, ask.from});
}

void Answering::Worker::work(TextReply text) {
  const std::shared_ptr<Client> client = owner_.clients_.find(text.client);
  if (client) {
    write_text(*client, text.request, text.status, text.text, text.is_recorded);
  } else {
    ++owner_.with_.counts.unanswerable;
  }
}

void Answering::Worker::work(Farewell farewell) {
  const std::shared_ptr<Client> client = owner_.clients_.departed(farewell.client);
  write_text(*client, 0, ReplyStatus::ok, wire_contract::command::kClientGone, true);
}

void Answering::Worker::work(Resume resume) {
  for (AskPointer& ask : owner_.clients_.resume(resume.place)) work(std::move(ask));
}

void Answering::Worker::work(ExpireLeases gone) {
  for (AskPointer& ask : owner_.clients_.forget_gone(gone.query_owners, steady_ns())) {
    ++owner_.with_.counts.unanswerable;
    owner_.pool_.put(std::move(ask));
  }
}

/// Steady clock; 0: none.
std::int64_t Answering::Worker::deadline_of(const Ask& ask) const {
  const std::int64_t asked_ns = ask.query->deadline_ns;
  const std::int64_t allowed_ns = asked_ns > 0 ? asked_ns : owner_.options_.deadline_ns;
  return allowed_ns > 0 ? ask.taken_ns + std::min(allowed_ns, std::int64_t{1} << 60) : 0;
}

/// Whether answers_ has fewer than `count` answers. A question that was called off has none: they were cut short.
bool Answering::Worker::is_unfinished(const Client& client, std::size_t count) {
  if (client.called_off().load()) answers_.reset(0);
  return answers_.answers.size() < count;
}

/// How long the next question may take.
SearchTime Answering::Worker::time_for(const Client& client, const Ask& ask) const {
  const bool is_limited = patience_ns_ > 0 && !ask.is_costly;
  return {.deadline_ns = deadline_of(ask),
          .give_up_ns = is_limited ? steady_ns() + patience_ns_ : 0,
          .called_off = &client.called_off()};
}

/// What-if configurations. Every chunk of a request repeats the moved objects, and all are answered on one state.
void Answering::Worker::answer_configurations(Client& client, Ask& ask) {
  const wire::Query& query = *ask.query;
  const auto refuse = [&](const std::string& reason) {
    ++owner_.with_.counts.refused;
    write_text(client, query.request, ReplyStatus::refused, refusal_text(reason));
  };
  const auto lease = std::make_shared<SnapshotRing::Lease>(ask.hold ? ask.hold.state() : owner_.with_.world.newest());
  if (!find_past(client, ask, **lease)) return;
  const std::shared_ptr<const Snapshot> state = ask.past ? ask.past : std::shared_ptr<const Snapshot>(lease, &**lease);
  const auto asked = what_if_asked(query, *state);
  if (const auto* refusal = std::get_if<Refusal>(&asked)) return refuse(refusal->reason);
  wire::gather_rows(query, wire::question_columns(QuestionKind::what_if), numbers_);
  const std::int64_t began_ns = steady_ns();
  WhatIf what_if(state, std::get<WhatIfAsk>(asked), owner_.with_.part_meshes);
  const std::span<const double> rows = rows_left(ask);
  const std::size_t left = rows.size() / (what_if.moved_count() * kPoseNumbers);
  // The set-up at the start of a turn should take a small part of it.
  const std::int64_t now_ns = steady_ns();
  const std::int64_t turn_ns = std::max(kTurnNs, 8 * (now_ns - began_ns));
  const bool may_pause = left > 1 && (ask.past || ask.hold || owner_.with_.leases.keep(ask, *lease, now_ns));
  SearchTime time = time_for(client, ask);
  if (time.give_up_ns != 0) time.give_up_ns = left == 1 || may_pause ? now_ns + 2 * turn_ns : 0;
  answer_what_if(
      what_if, rows, time, may_pause ? now_ns + turn_ns : 0, [&] { return owner_.knows(query.client); }, answers_);
  is_paused_ = is_unfinished(client, left);
  if (is_paused_ && answers_.answers.empty()) return;
  if (owner_.options_.recovering()) doubt({.kind = QuestionKind::what_if, .numbers = {}});
  write_answers(client, ask, *state);
  ask.answered += answers_.answers.size();
}

/// The rows in numbers_ that have no answer yet.
std::span<const double> Answering::Worker::rows_left(const Ask& ask) const {
  const std::size_t count = wire::question_count(*ask.query).value_or(0);
  return count == 0 ? std::span<const double>() : std::span(numbers_).subspan(ask.answered * (numbers_.size() / count));
}

void Answering::Worker::answer_questions(Client& client, Ask& ask, const ObjectInfo* mover) {
  const wire::Query& query = *ask.query;
  wire::gather_rows(query, wire::question_columns(static_cast<QuestionKind>(query.kind)), numbers_);
  const std::span<const double> rows = rows_left(ask);
  const SearchTime time = time_for(client, ask);
  const bool with_hits = query.mode != static_cast<std::uint8_t>(wire_contract::HitMode::verdict);
  Questions questions{.kind = static_cast<QuestionKind>(query.kind),
                      .mode = with_hits ? static_cast<HitMode>(query.mode) : HitMode::any,
                      .with_hits = with_hits,
                      .mask = query.mask,
                      .max_hits = query.max_hits,
                      .only = query.only,
                      .skip = query.skip,
                      .deadline_ns = time.deadline_ns,
                      .give_up_ns = time.give_up_ns,
                      .called_off = time.called_off,
                      .error_m = query.error_asked > 0 ? query.error_asked : owner_.options_.error_m,
                      .numbers = rows,
                      .mover = mover};
  const SnapshotRing::Lease lease = ask.hold ? ask.hold.state() : owner_.with_.world.newest();
  if (restore_float_environment()) ++owner_.with_.counts.float_repairs;
  if (!find_past(client, ask, *lease)) return;
  const Snapshot& state = ask.past ? *ask.past : *lease;
  const std::size_t left = rows.size() / engine::numbers_of(questions.kind);
  if (left > 1) questions.pause_ns = steady_ns() + kTurnNs;
  const std::uint64_t dropped_before = scratch_.filters.dropped();
  engine::answer(state, questions, answers_, scratch_);
  const std::size_t answered = answers_.answers.size();
  if (answered > 0 && answered < left && !ask.past && !ask.hold && !owner_.with_.leases.keep(ask, lease, steady_ns())) {
    questions.pause_ns = questions.give_up_ns = 0;  // the rest needs this state, which cannot be kept
    engine::answer(state, questions, answers_, scratch_);
  }
  if (const std::uint64_t dropped = scratch_.filters.dropped() - dropped_before; dropped > 0)
    owner_.with_.counts.filters_dropped += dropped;
  is_paused_ = is_unfinished(client, left);
  if (is_paused_ && answers_.answers.empty()) return;
  // Objects may be missing until their publishers are back. A hit is real all the same, and enough if any hit will do;
  // every other answer may still change.
  if (owner_.options_.recovering()) doubt(questions);
  doubt_where_not_held(state, questions, answers_);
  write_answers(client, ask, state);
  // The audit has no brute force for sweeps, and only reads the newest states. An overloaded server skips audit and
  // samples.
  const bool is_overloaded = owner_.options_.overload != nullptr && owner_.options_.overload->leaves_out_details();
  questions.numbers = rows.first(answers_.answers.size() * engine::numbers_of(questions.kind));
  if (mover == nullptr && !ask.past && !is_overloaded) owner_.with_.audit.consider(lease, questions, answers_);
  if (owner_.with_.samples.wants(ask.taken_ns) && mover == nullptr && !is_overloaded)
    owner_.with_.samples.take(state, questions, answers_, query.client, ask.taken_ns);
  ask.answered += answers_.answers.size();
}

/// Looks up the state of the past instant, if the ask has one, for all its turns.
///
/// returns  false: there is none, and the reply says so
bool Answering::Worker::find_past(Client& client, Ask& ask, const Snapshot& newest) {
  if (ask.query->instant == 0 || ask.past) return true;
  auto past = owner_.past_states_.at(instant_of(*ask.query), newest);
  if (const auto* refusal = std::get_if<std::string>(&past)) {
    ++owner_.with_.counts.refused;
    write_text(client, ask.query->request, ReplyStatus::refused, refusal_text(*refusal));
    return false;
  }
  ask.past = std::get<std::shared_ptr<const Snapshot>>(std::move(past));
  return true;
}

void Answering::Worker::count_levels(QuestionKind kind) {
  std::array<std::uint64_t, 3> counts{};
  for (const std::uint8_t level : answers_.levels) ++counts[level];
  auto& total = owner_.with_.counts.levels[static_cast<std::size_t>(kind)];
  for (std::size_t level = 0; level < counts.size(); ++level) {
    if (counts[level] > 0) total[level].fetch_add(counts[level], std::memory_order_relaxed);
  }
}

/// Turns every answer that a missing object could change into undecided.
void Answering::Worker::doubt(const Questions& questions) {
  const bool any_will_do = questions.kind == QuestionKind::what_if ||
                           (questions.kind == QuestionKind::ray && questions.mode == HitMode::any);
  for (std::size_t i = 0; i < answers_.answers.size(); ++i) {
    const bool hit = answers_.answers[i] == Verdict::hit;
    if (answers_.answers[i] != Verdict::miss && (!hit || any_will_do)) continue;
    answers_.answers[i] = Verdict::undecided;
    answers_.reasons[i] = UndecidedReason::recovering;
  }
}

void Answering::Worker::write_answers(Client& client, const Ask& ask, const Snapshot& snapshot) {
  const wire::Query& query = *ask.query;
  ReplyFiller filler(snapshot, answers_, named_in_, reply_number_);
  dds::borrow(reply_->text, std::span<const std::uint8_t>());
  reply_->client = query.client;
  reply_->request = query.request;
  reply_->chunk_index = query.chunk_index;
  reply_->chunk_count = query.chunk_count;
  reply_->status = static_cast<std::uint8_t>(ReplyStatus::ok);
  reply_->version = snapshot.version;
  reply_->world_time_ns = snapshot.world_time_ns;
  const std::int64_t posed_ns = answers_.oldest_pose_ns;
  reply_->oldest_pose_age_ns = posed_ns > 0 ? std::max<std::int64_t>(0, owner_.with_.clock.now_ns() - posed_ns) : -1;
  client.note_reported(snapshot.version);
  while (filler.fill(columns_)) {
    wire::lend(columns_, *reply_);
    reply_->first_question = query.first_question + static_cast<std::uint32_t>(ask.answered + filler.first());
    reply_->compute_ns = steady_ns() - ask.taken_ns;
    // Counted before the reply leaves: a client that has the reply and then asks for the counts finds it in them.
    if (filler.is_done()) count_answered(ask, filler.undecided());
    send(client);
  }
}

void Answering::Worker::count_answered(const Ask& ask, std::uint64_t undecided) {
  const std::uint8_t kind = ask.query->kind;
  if (!is_paused_ && !ask.is_part) owner_.with_.counts.durations[kind].add(reply_->compute_ns);
  owner_.with_.counts.answered += answers_.answers.size();
  owner_.with_.counts.undecided += undecided;
  count_levels(static_cast<QuestionKind>(kind));
}

/// Writes a text in as many replies as it needs, at least one.
void Answering::Worker::write_text(Client& client, std::uint64_t request, ReplyStatus status, std::string_view text,
                                   bool is_recorded) {
  wire::clear(columns_);
  wire::lend(columns_, *reply_);
  const SnapshotRing::Lease lease = owner_.with_.world.newest();
  constexpr std::size_t kMost = wire_contract::kMaxTextBytesPerChunk;
  const std::size_t chunks = std::max<std::size_t>(1, (text.size() + kMost - 1) / kMost);
  reply_->client = client.id();
  reply_->request = request;
  reply_->chunk_count = static_cast<std::uint32_t>(chunks);
  reply_->first_question = 0;
  reply_->status = static_cast<std::uint8_t>(status);
  reply_->version = lease->version;
  reply_->world_time_ns = lease->world_time_ns;
  reply_->oldest_pose_age_ns = -1;
  reply_->compute_ns = 0;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    const std::string_view part = text.substr(std::min(text.size(), chunk * kMost), kMost);
    text_.assign(part.begin(), part.end());
    dds::borrow(reply_->text, text_);
    reply_->chunk_index = static_cast<std::uint32_t>(chunk);
    send(client, is_recorded);
  }
}

void Answering::Worker::send(Client& client, bool is_recorded) {
  if (!owner_.with_.place.may_publish()) {
    ++owner_.with_.counts.unanswerable;
    return;
  }
  reply_->epoch = owner_.epoch_.load(std::memory_order_relaxed);
  if (owner_.options_.flight && is_recorded) owner_.options_.flight->note(recording::Recorded::reply, *reply_);
  try {
    if (!client.write(*reply_)) ++owner_.with_.counts.unanswerable;
  } catch (const dds::DdsError&) { ++owner_.with_.counts.unanswerable; }
}

}  // namespace collided::engine::service
