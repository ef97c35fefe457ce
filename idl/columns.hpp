#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "idl/dds.hpp"
#include "idl/messages.hpp"

/// Converts between rows of numbers, as programs keep them, and the named columns of collided.idl, as they travel. A
/// ray is a row of seven numbers: its origin goes to `points`, its direction to `directions`, its length to `lengths`.
namespace collided::wire {

template <class Message>
struct Column {
  dds_sequence_double Message::*sequence;
  std::uint32_t width;  // numbers per row: 1, 3 or 4
};

/// The number columns of a message that have an entry for each row.
template <class Columns>
constexpr auto number_columns() {
  using Numbers = dds_sequence_double Columns::Message::*;
  constexpr std::size_t kCount = [] {
    std::size_t count = 0;
    Columns::for_each(
        [&]<class Sequence>(Sequence, auto, std::uint32_t) { count += std::is_same_v<Sequence, Numbers>; });
    return count;
  }();
  std::array<Column<typename Columns::Message>, kCount> columns{};
  std::size_t number = 0;
  Columns::for_each([&]<class Sequence>(Sequence sequence, auto, std::uint32_t width) {
    if constexpr (std::is_same_v<Sequence, Numbers>) columns[number++] = {sequence, width};
  });
  return columns;
}
/// The columns of these sequences, with the widths of the contract.
template <class Columns, auto... kSequences>
constexpr auto columns_of() {
  constexpr auto kAll = number_columns<Columns>();
  return std::array{*std::ranges::find(kAll, kSequences, &Column<typename Columns::Message>::sequence)...};
}

inline constexpr auto kRayColumns = columns_of<QueryColumns, &Query::points, &Query::directions, &Query::lengths>();
inline constexpr auto kSphereColumns = columns_of<QueryColumns, &Query::points, &Query::radii>();
inline constexpr auto kBoxColumns =
    columns_of<QueryColumns, &Query::points, &Query::half_sizes, &Query::orientations>();
inline constexpr auto kNearColumns = columns_of<QueryColumns, &Query::points, &Query::lengths>();
inline constexpr auto kInsideColumns = columns_of<QueryColumns, &Query::points>();
/// One row for each pose. A configuration has as many rows as the question names objects.
inline constexpr auto kWhatIfColumns = columns_of<QueryColumns, &Query::points, &Query::orientations>();
inline constexpr auto kSweepColumns =
    columns_of<QueryColumns, &Query::points, &Query::orientations, &Query::end_points, &Query::end_orientations>();
inline constexpr auto kPoseColumns = columns_of<PoseBatchColumns, &PoseBatch::positions, &PoseBatch::orientations>();
inline constexpr auto kVelocityColumns =
    columns_of<PoseBatchColumns, &PoseBatch::linear_velocities, &PoseBatch::angular_velocities>();
inline constexpr auto kHitColumns =
    columns_of<ReplyColumns, &Reply::distances, &Reply::distance_errors, &Reply::exits, &Reply::points, &Reply::normals,
               &Reply::weights, &Reply::point_errors>();
/// A hit of a sweep begins with the end of the bracket, its width and its beginning; the rest is as in other hits.
inline constexpr auto kSweepHitColumns =
    columns_of<ReplyColumns, &Reply::sweep_ends, &Reply::sweep_widths, &Reply::sweep_begins, &Reply::points,
               &Reply::normals, &Reply::weights, &Reply::point_errors>();
inline constexpr auto kUncoveredColumns =
    columns_of<ReplyColumns, &Reply::uncovered_points, &Reply::uncovered_distances>();
inline constexpr auto kEventColumns = number_columns<EventFrameColumns>();
inline constexpr auto kContactColumns = number_columns<ContactShardColumns>();
inline constexpr auto kProbeColumns = number_columns<ProbeFrameColumns>();
template <class Message>
using Columns = std::span<const Column<Message>>;

/// Clears all columns; they keep their memory.
template <class Columns>
void clear(Columns& columns) {
  Columns::for_each([&](auto, auto column, std::uint32_t) { (columns.*column).clear(); });
}
/// Points the message at the columns, without a copy; valid until they change.
template <class Columns>
void lend(const Columns& columns, typename Columns::Message& message) {
  Columns::for_each(
      [&](auto sequence, auto column, std::uint32_t) { dds::borrow(message.*sequence, columns.*column); });
}
/// True if each column with one entry per row has this many rows.
template <class Columns>
bool has_rows(const typename Columns::Message& message, std::size_t rows) {
  bool fits = true;
  Columns::for_each([&](auto sequence, auto, std::uint32_t width) {
    fits = fits && (width == 0 || (message.*sequence)._length == rows * width);
  });
  return fits;
}
/// Size of a row in a message, in bytes.
template <class Columns>
constexpr std::size_t bytes_of_row() {
  std::size_t bytes = 0;
  Columns::for_each(
      [&]<class Value>(auto, std::vector<Value> Columns::*, std::uint32_t width) { bytes += width * sizeof(Value); });
  return bytes;
}

/// The columns of questions of this kind; empty for commands and other kinds without questions about the world.
Columns<Query> question_columns(wire_contract::QuestionKind kind);
/// The columns of a reply's hits: those of sweeps if any of these is filled.
Columns<Reply> hit_columns(const Reply& reply);

template <class Message>
constexpr std::uint32_t width_of(Columns<Message> columns) {
  std::uint32_t width = 0;
  for (const Column<Message>& column : columns) width += column.width;
  return width;
}
static_assert(width_of<PoseBatch>(kVelocityColumns) == wire_contract::kVelocityNumbers);
static_assert(width_of<Reply>(kHitColumns) == wire_contract::kHitNumbers);

/// Number of rows; nothing if the columns differ in length.
template <class Message>
std::optional<std::uint32_t> row_count(const Message& message, Columns<Message> columns) {
  std::uint32_t count = 0;
  for (const Column<Message>& column : columns) {
    const std::uint32_t length = (message.*column.sequence)._length;
    const std::uint32_t rows = length / column.width;
    if (length % column.width != 0 || (&column != columns.data() && rows != count)) return std::nullopt;
    count = rows;
  }
  return count;
}

/// Number of questions in a message. Nothing if its columns differ in length, if columns of another kind are filled, or
/// if the poses of a what-if are not a whole number of configurations.
std::optional<std::uint32_t> question_count(const Query& query);

/// Number of objects that the blob of a what-if names: zero-terminated names, one after the other.
std::uint32_t moved_count(const Query& query);

/// Size of a message and its columns, in bytes.
std::size_t bytes_of(const Query& query);
/// Memory allocated by a message, in bytes, including unused capacity of its columns.
std::size_t room_of(const Query& query);

/// Copies kWidth numbers `count` times, from every from_stride-th number to every to_stride-th.
template <std::size_t kWidth>
void copy_strided(const double* from, std::size_t from_stride, double* to, std::size_t to_stride, std::size_t count) {
  for (; count > 0; --count, from += from_stride, to += to_stride) std::memcpy(to, from, kWidth * sizeof(double));
}
/// Copies rows of width 1, 3 or 4. With a constant width the compiler moves a row's numbers at once.
inline void copy_rows(std::uint32_t width, const double* from, std::size_t from_stride, double* to,
                      std::size_t to_stride, std::size_t count) {
  switch (width) {
    case 1: return copy_strided<1>(from, from_stride, to, to_stride, count);
    case 3: return copy_strided<3>(from, from_stride, to, to_stride, count);
    default: return copy_strided<4>(from, from_stride, to, to_stride, count);
  }
}

/// How long the server's world has been busy with one step, by this status; 0: it is not busy (kPublisherBusyWorld).
std::int64_t busy_ns(const Status& status);

/// Puts rows into `memory` by columns and points the message there; `memory` must outlive the write.
template <class Message>
void lend_columns(std::span<const double> rows, Columns<Message> columns, std::vector<double>& memory,
                  Message& message) {
  if (columns.empty()) return;
  const std::size_t width = width_of(columns), count = rows.size() / width;
  memory.resize(count * width);
  double* to = memory.data();
  std::size_t offset = 0;
  for (const Column<Message>& column : columns) {
    dds::borrow(message.*column.sequence, std::span(to, count * column.width));
    copy_rows(column.width, rows.data() + offset, width, to, column.width, count);
    to += count * column.width;
    offset += column.width;
  }
}

/// Moves the questions from number `first` on from `from` to `to`. `to` must not borrow its sequences; their memory is
/// reused.
///
/// first  below question_count(from); not for a what-if
void split_questions(Query& from, std::uint32_t first, Query& to);

/// Clears the columns of every kind of question.
void clear_questions(Query& query);

/// Reads the rows of a message whose columns have equal length (row_count()).
template <class Message>
void gather_rows(const Message& message, Columns<Message> columns, std::vector<double>& rows) {
  rows.clear();
  if (columns.empty()) return;
  const std::size_t width = width_of(columns),
                    count = (message.*columns.front().sequence)._length / columns.front().width;
  rows.resize(count * width);
  std::size_t offset = 0;
  for (const Column<Message>& column : columns) {
    copy_rows(column.width, (message.*column.sequence)._buffer, column.width, rows.data() + offset, width, count);
    offset += column.width;
  }
}

}  // namespace collided::wire
