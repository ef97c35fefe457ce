#include "server/service/ask.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "server/service/border.hpp"

namespace collided::service {
namespace {

using wire_contract::QueryKind;
using wire_contract::RayMode;

struct Kind {
  const char* name;
  std::uint32_t numbers;  // per question
};

std::optional<Kind> kind_of(std::uint8_t code) {
  switch (static_cast<QueryKind>(code)) {
    case QueryKind::ray:
      return Kind{"ray", wire_contract::kRayNumbers};
    case QueryKind::sphere:
      return Kind{"sphere", wire_contract::kSphereNumbers};
    case QueryKind::box:
      return Kind{"box", wire_contract::kBoxNumbers};
    case QueryKind::near:
      return Kind{"near", wire_contract::kNearNumbers};
    default:
      return std::nullopt;
  }
}

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

AskPointer AskPool::get() {
  const std::lock_guard lock(mutex_);
  if (spares_.empty()) return std::make_unique<Ask>();
  AskPointer ask = std::move(spares_.back());
  spares_.pop_back();
  return ask;
}

void AskPool::put(AskPointer ask) {
  ask->pinned = {};
  ask->passed_fence = false;
  ask->refusal.clear();
  const std::lock_guard lock(mutex_);
  if (spares_.size() < kMost) spares_.push_back(std::move(ask));
}

std::optional<std::string> why_refused(const wire::Query& query) {
  if (query.kind > static_cast<std::uint8_t>(QueryKind::command)) {
    return fmt::format("question kind {} is not known; allowed 0 to {}", query.kind,
                       static_cast<unsigned>(QueryKind::command));
  }
  const std::optional<Kind> kind = kind_of(query.kind);
  if (!kind) return std::nullopt;
  const std::size_t count = query.numbers._length;
  if (count == 0 || count % kind->numbers != 0) {
    return fmt::format("{} numbers for {} questions; {} are needed for each", count, kind->name, kind->numbers);
  }
  if (auto reason = why_bad_chunk(query, count / kind->numbers)) return reason;
  if (query.mode > static_cast<std::uint8_t>(RayMode::all)) {
    return fmt::format("ray mode {} is not known; allowed 0 to {}", query.mode, static_cast<unsigned>(RayMode::all));
  }
  if (query.max_hits == 0 || query.max_hits > wire_contract::kMaxHitsPerChunk) {
    return fmt::format("max_hits {}; allowed 1 to {}", query.max_hits, wire_contract::kMaxHitsPerChunk);
  }
  if (query.deadline_ns < 0) return fmt::format("deadline {} ns; allowed 0 (none) and more", query.deadline_ns);
  if (!(query.error_asked_m >= 0)) return fmt::format("error asked {} m; allowed 0 and more", query.error_asked_m);
  return why_bad_filter(query);
}

}  // namespace collided::service
