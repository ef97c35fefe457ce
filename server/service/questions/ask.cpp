#include "server/service/questions/ask.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "idl/columns.hpp"
#include "idl/instant.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::AskedInstant;
using wire_contract::HitMode;
using wire_contract::Importance;
using wire_contract::kMaxPosesPerChunk;
using wire_contract::QuestionKind;

std::optional<std::string> why_bad_chunk(const wire::Query& query, std::size_t questions) {
  using wire_contract::kMaxQuestionsPerRequest;
  if (query.chunk_count == 0 || query.chunk_count > kMaxQuestionsPerRequest) {
    return fmt::format("a request of {} chunks; allowed 1 to {}", query.chunk_count, kMaxQuestionsPerRequest);
  }
  if (query.chunk_index >= query.chunk_count) {
    return fmt::format("chunk number {} of {} chunks; they count from 0", query.chunk_index, query.chunk_count);
  }
  if (questions > wire_contract::kMaxQuestionsPerChunk) {
    return fmt::format("a chunk of {} questions; allowed {}", questions, wire_contract::kMaxQuestionsPerChunk);
  }
  if (query.first_question > kMaxQuestionsPerRequest - questions) {
    return fmt::format("question {} and {} more; a request has at most {}", query.first_question, questions,
                       kMaxQuestionsPerRequest);
  }
  return std::nullopt;
}

template <class Code>
std::optional<std::string> why_unknown(const char* noun, std::uint8_t code) {
  if (wire_contract::is_known<Code>(code)) return std::nullopt;
  return fmt::format("{} {} is not known; allowed 0 to {}", noun, code, wire_contract::kCodeCount<Code> - 1);
}

std::optional<std::string> why_bad_filter(const wire::Query& query) {
  for (const char* pattern : {query.only, query.skip}) {
    if (*pattern && !is_good_name(pattern)) return fmt::format("the name pattern {} is not text", printable(pattern));
  }
  return std::nullopt;
}

bool has_mode(QuestionKind kind, HitMode mode) {
  switch (mode) {
    case HitMode::signed_near: return kind == QuestionKind::near;
    case HitMode::verdict:
      return kind == QuestionKind::ray || kind == QuestionKind::sphere || kind == QuestionKind::box ||
             kind == QuestionKind::inside;
    default: return true;
  }
}

}  // namespace

void Ask::reset() {
  hold = {};
  past.reset();
  passed_barrier = false;
  refusal.clear();
  retry_after_ns = 0;
  is_costly = is_part = false;
  answered = 0;
}

AskPool::AskPool() {
  spares_.reserve(kMost);
  for (std::size_t i = 0; i < kAtFirst; ++i) spares_.push_back(std::make_unique<Ask>());
}

AskPointer AskPool::get() {
  const std::lock_guard lock(mutex_);
  if (spares_.empty()) return std::make_unique<Ask>();
  AskPointer ask = std::move(spares_.back());
  spares_.pop_back();
  return ask;
}

void AskPool::put(AskPointer ask) {
  if (wire::room_of(*ask->query) > kMostBytes) return;
  ask->reset();
  const std::lock_guard lock(mutex_);
  if (spares_.size() < kMost) spares_.push_back(std::move(ask));
}

bool is_single(const wire::Query& query) { return query.chunk_count == 1 && wire::question_count(query) == 1U; }

/// The weights follow the table of times in the guide to accuracy (deploy/docs), where a ray takes 0.3 us; a nearest
/// point and a time of contact cost an order of magnitude more.
double cost_of(const wire::Query& query) {
  const auto kind = static_cast<QuestionKind>(query.kind);
  const double questions = std::max(1U, wire::question_count(query).value_or(1));
  // The state of a past instant has to be put together first.
  const double state = query.instant != static_cast<std::uint8_t>(AskedInstant::Kind::latest) ? 2'000 : 0;
  switch (kind) {
    case QuestionKind::sphere: return state + 2 * questions;
    case QuestionKind::box: return state + 3 * questions;
    case QuestionKind::inside: return state + 3 * questions;
    case QuestionKind::near: return state + 25 * questions;
    case QuestionKind::sweep: return state + 45 * questions;
    case QuestionKind::what_if: return state + 200 * questions * std::max(1U, wire::moved_count(query));
    case QuestionKind::command: return 1'000;
    default: return state + questions;
  }
}

std::optional<std::string> why_refused(const wire::Query& query) {
  if (auto reason = why_unknown<QuestionKind>("question kind", query.kind)) return reason;
  const auto kind = static_cast<QuestionKind>(query.kind);
  if (wire::question_columns(kind).empty()) return std::nullopt;
  const std::optional<std::uint32_t> count = wire::question_count(query);
  if (!count || *count == 0) {
    return fmt::format("the columns of {} questions are {}", wire_contract::name_of(kind),
                       count ? "empty" : "not of one length, or others are filled too");
  }
  if (auto reason = why_bad_chunk(query, *count)) return reason;
  if (kind == QuestionKind::what_if && std::uint64_t{*count} * wire::moved_count(query) > kMaxPosesPerChunk)
    return fmt::format("a chunk of {} poses; allowed {}", std::uint64_t{*count} * wire::moved_count(query),
                       kMaxPosesPerChunk);
  if (auto reason = why_unknown<HitMode>("hit mode", query.mode)) return reason;
  if (!has_mode(kind, static_cast<HitMode>(query.mode)))
    return fmt::format("{} questions do not have hit mode {}", wire_contract::name_of(kind), query.mode);
  if (auto reason = why_unknown<Importance>("importance", query.importance)) return reason;
  if (auto reason = why_unknown<AskedInstant::Kind>("instant", query.instant)) return reason;
  if (query.max_hits == 0 || query.max_hits > wire_contract::kMaxHitsPerChunk) {
    return fmt::format("max_hits {}; allowed 1 to {}", query.max_hits, wire_contract::kMaxHitsPerChunk);
  }
  if (query.instant_ns < 0) return fmt::format("the instant {} ns; allowed 0 and more", query.instant_ns);
  if (query.deadline_ns < 0) return fmt::format("deadline {} ns; allowed 0 (none) and more", query.deadline_ns);
  if (!(query.error_asked >= 0)) return fmt::format("error asked {} m; allowed 0 and more", query.error_asked);
  return why_bad_filter(query);
}

}  // namespace collided::engine::service
