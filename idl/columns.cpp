#include "idl/columns.hpp"

#include <algorithm>
#include <array>

namespace collided::wire {
namespace {

using wire_contract::QuestionKind;

constexpr auto kQuestionColumns = number_columns<QueryColumns>();

}  // namespace

Columns<Query> question_columns(QuestionKind kind) {
  switch (kind) {
    case QuestionKind::ray: return kRayColumns;
    case QuestionKind::sphere: return kSphereColumns;
    case QuestionKind::box: return kBoxColumns;
    case QuestionKind::near: return kNearColumns;
    case QuestionKind::sweep: return kSweepColumns;
    case QuestionKind::inside: return kInsideColumns;
    case QuestionKind::what_if: return kWhatIfColumns;
    default: return {};
  }
}

Columns<Reply> hit_columns(const Reply& reply) {
  if (reply.sweep_ends._length > 0) return kSweepHitColumns;
  return kHitColumns;
}

std::optional<std::uint32_t> question_count(const Query& query) {
  const Columns<Query> columns = question_columns(static_cast<QuestionKind>(query.kind));
  for (const Column<Query>& each : kQuestionColumns) {
    const bool is_own =
        std::any_of(columns.begin(), columns.end(), [&](const auto& own) { return own.sequence == each.sequence; });
    if (!is_own && (query.*each.sequence)._length > 0) return std::nullopt;
  }
  const std::optional<std::uint32_t> rows = row_count(query, columns);
  if (!rows || query.kind != static_cast<std::uint8_t>(QuestionKind::what_if)) return rows;
  const std::uint32_t poses = moved_count(query);
  if (poses == 0 || *rows % poses != 0) return std::nullopt;
  return *rows / poses;
}

std::uint32_t moved_count(const Query& query) {
  const auto blob = dds::view(query.blob);
  return static_cast<std::uint32_t>(std::count(blob.begin(), blob.end(), std::uint8_t{0}));
}

std::size_t bytes_of(const Query& query) {
  std::size_t bytes = sizeof(Query) + query.blob._length;
  for (const auto& column : kQuestionColumns) bytes += (query.*column.sequence)._length * sizeof(double);
  return bytes;
}

std::size_t room_of(const Query& query) {
  std::size_t bytes = sizeof(Query) + query.blob._maximum;
  for (const auto& column : kQuestionColumns) bytes += (query.*column.sequence)._maximum * sizeof(double);
  return bytes;
}

std::int64_t busy_ns(const Status& status) {
  const auto publishers = dds::view(status.publishers);
  const auto silent = dds::view(status.silent_ns);
  const bool is_busy = !publishers.empty() && publishers.size() == silent.size() &&
                       publishers.back() == wire_contract::kPublisherBusyWorld;
  return is_busy ? std::max<std::int64_t>(1, silent.back()) : 0;
}

namespace {

template <class Sequence>
void copy_part(const Sequence& from, std::uint32_t first, std::uint32_t count, Sequence& to) {
  if (to._maximum < count) {
    if (to._release) dds_free(to._buffer);
    to._buffer = static_cast<decltype(to._buffer)>(dds_alloc(count * sizeof(*to._buffer)));
    to._maximum = count;
    to._release = true;
  }
  to._length = count;
  if (count > 0) std::memcpy(to._buffer, from._buffer + first, count * sizeof(*to._buffer));
}

}  // namespace

void split_questions(Query& from, std::uint32_t first, Query& to) {
  const std::uint32_t count = question_count(from).value_or(0);
  std::array<dds_sequence_double, kQuestionColumns.size()> memory;
  std::ranges::transform(kQuestionColumns, memory.begin(), [&](const auto& column) { return to.*column.sequence; });
  auto blob = to.blob;
  to = from;
  copy_part(from.blob, 0, from.blob._length, blob);
  to.blob = blob;
  for (std::size_t i = 0; i < memory.size(); ++i) {
    dds_sequence_double& column = from.*kQuestionColumns[i].sequence;
    const std::uint32_t kept = column._length / count * first;
    copy_part(column, kept, column._length - kept, memory[i]);
    to.*kQuestionColumns[i].sequence = memory[i];
    column._length = kept;
  }
  to.first_question += first;
}

void clear_questions(Query& query) {
  for (const auto& column : kQuestionColumns) dds::borrow(query.*column.sequence, std::span<const double>());
}

}  // namespace collided::wire
