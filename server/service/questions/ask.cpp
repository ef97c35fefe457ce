#include "server/service/questions/ask.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "idl/instant.hpp"
#include "idl/question_class.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::QueryKind;
using wire_contract::QuestionClass;
using wire_contract::RayMode;

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

std::optional<std::string> why_bad_filter(const wire::Query& query) {
  for (const char* pattern : {query.only, query.skip}) {
    if (*pattern && !is_good_name(pattern)) return fmt::format("the name pattern {} is not text", printable(pattern));
  }
  return std::nullopt;
}

}  // namespace

void Ask::reset() {
  pinned = {};
  passed_fence = false;
  refusal.clear();
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
  ask->reset();
  const std::lock_guard lock(mutex_);
  if (spares_.size() < kMost) spares_.push_back(std::move(ask));
}

bool is_single(const wire::Query& query) {
  const std::uint32_t numbers = wire_contract::numbers_of(static_cast<QueryKind>(query.kind));
  return query.chunk_count == 1 && numbers != 0 && query.numbers._length == numbers;
}

/// The README's table of times, a ray being 0.3 us; a nearest point and a time of contact are of another order.
double cost_of(const wire::Query& query) {
  const auto kind = static_cast<QueryKind>(query.kind);
  const std::uint32_t numbers = wire_contract::numbers_of(kind);
  const double questions = numbers == 0 ? 1 : std::max(1U, query.numbers._length / numbers);
  // A state at a past instant is put together first.
  const double state = numbers > 0 && query.text[0] != 0 ? 2'000 : 0;
  switch (kind) {
    case QueryKind::sphere: return state + 2 * questions;
    case QueryKind::box: return state + 3 * questions;
    case QueryKind::near: return state + 25 * questions;
    case QueryKind::sweep: return state + 45 * questions;
    case QueryKind::command: return 1'000;
    default: return state + questions;
  }
}

std::optional<std::string> why_refused(const wire::Query& query) {
  if (query.kind > static_cast<std::uint8_t>(QueryKind::sweep)) {
    return fmt::format("question kind {} is not known; allowed 0 to {}", query.kind,
                       static_cast<unsigned>(QueryKind::sweep));
  }
  const auto kind = static_cast<QueryKind>(query.kind);
  const std::uint32_t per_question = wire_contract::numbers_of(kind);
  if (per_question == 0) return std::nullopt;
  const std::size_t count = query.numbers._length;
  if (count == 0 || count % per_question != 0) {
    return fmt::format("{} numbers for {} questions; {} are needed for each", count, wire_contract::name_of(kind),
                       per_question);
  }
  if (auto reason = why_bad_chunk(query, count / per_question)) return reason;
  const RayMode mode = wire_contract::ray_mode(query.mode);
  if (mode > RayMode::all) {
    return fmt::format("ray mode {} is not known; allowed 0 to {}", static_cast<unsigned>(mode),
                       static_cast<unsigned>(RayMode::all));
  }
  if (wire_contract::question_class(query.mode) > QuestionClass::high) {
    return fmt::format("question class 3 is not known; allowed 0 to {}", static_cast<unsigned>(QuestionClass::high));
  }
  if (query.max_hits == 0 || query.max_hits > wire_contract::kMaxHitsPerChunk) {
    return fmt::format("max_hits {}; allowed 1 to {}", query.max_hits, wire_contract::kMaxHitsPerChunk);
  }
  if (!wire_contract::asked_instant(query.text)) {
    return fmt::format("the instant {}; allowed are nothing, settled, ns since 1970 and -ns before the newest", printable(query.text));
  }
  if (query.deadline_ns < 0) return fmt::format("deadline {} ns; allowed 0 (none) and more", query.deadline_ns);
  if (!(query.error_asked_m >= 0)) return fmt::format("error asked {} m; allowed 0 and more", query.error_asked_m);
  return why_bad_filter(query);
}

}  // namespace collided::engine::service
