#include "idl/columns.hpp"

#include <algorithm>

namespace collided::wire {
namespace {

using wire_contract::RequestKind;

constexpr dds_sequence_double Query::*kQuestionSequences[] = {
    &Query::points,     &Query::directions,   &Query::lengths,    &Query::radii,
    &Query::half_sizes, &Query::orientations, &Query::end_points, &Query::end_orientations};

}  // namespace

Columns<Query> question_columns(RequestKind kind) {
  switch (kind) {
    case RequestKind::ray: return kRayColumns;
    case RequestKind::sphere: return kSphereColumns;
    case RequestKind::box: return kBoxColumns;
    case RequestKind::near: return kNearColumns;
    case RequestKind::sweep: return kSweepColumns;
    case RequestKind::inside: return kInsideColumns;
    case RequestKind::what_if: return kWhatIfColumns;
    default: return {};
  }
}

Columns<Reply> hit_columns(const Reply& reply) {
  if (reply.sweep_ends._length > 0) return kSweepHitColumns;
  return kHitColumns;
}

std::optional<std::uint32_t> question_count(const Query& query) {
  const Columns<Query> columns = question_columns(static_cast<RequestKind>(query.kind));
  for (const auto sequence : kQuestionSequences) {
    const bool is_own =
        std::any_of(columns.begin(), columns.end(), [&](const auto& column) { return column.sequence == sequence; });
    if (!is_own && (query.*sequence)._length > 0) return std::nullopt;
  }
  const std::optional<std::uint32_t> rows = row_count(query, columns);
  if (!rows || query.kind != static_cast<std::uint8_t>(RequestKind::what_if)) return rows;
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
  for (const auto sequence : kQuestionSequences) bytes += (query.*sequence)._length * sizeof(double);
  return bytes;
}

std::size_t room_of(const Query& query) {
  std::size_t bytes = sizeof(Query) + query.blob._maximum;
  for (const auto sequence : kQuestionSequences) bytes += (query.*sequence)._maximum * sizeof(double);
  return bytes;
}

std::int64_t busy_ns(const Status& status) {
  const auto publishers = dds::view(status.publishers);
  const auto silent = dds::view(status.silent_ns);
  const bool is_busy =
      !publishers.empty() && publishers.size() == silent.size() && publishers.back() == wire_contract::kBusyWorld;
  return is_busy ? std::max<std::int64_t>(1, silent.back()) : 0;
}

void clear_questions(Query& query) {
  for (const auto sequence : kQuestionSequences) dds::borrow(query.*sequence, std::span<const double>());
}

}  // namespace collided::wire
