#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "idl/columns.hpp"

/// Rows of numbers in messages that tests make and read, whatever columns they travel in.
namespace collided::test {

/// The message owns its copies.
template <class Message>
void put_rows(Message& message, wire::Columns<Message> columns, std::span<const double> rows) {
  std::vector<double> memory;
  wire::lend_columns(rows, columns, memory, message);
  for (const wire::Column<Message>& column : columns) {
    dds_sequence_double& sequence = message.*column.sequence;
    const std::span<const double> lent(sequence._buffer, sequence._length);
    sequence._buffer = static_cast<double*>(dds_alloc(std::max<std::size_t>(lent.size_bytes(), 1)));
    std::copy(lent.begin(), lent.end(), sequence._buffer);
    sequence._release = true;
  }
}

/// Questions of the query's kind, a row each; as many numbers as are no whole row are left out.
inline void put_questions(wire::Query& query, std::span<const double> rows) {
  wire::clear_questions(query);
  put_rows(query, wire::question_columns(static_cast<wire_contract::QuestionKind>(query.kind)), rows);
}
inline void put_poses(wire::PoseBatch& batch, std::span<const double> rows) {
  put_rows<wire::PoseBatch>(batch, wire::kPoseColumns, rows);
}

/// Of a copy that shares its sequences with another message: points to none of them.
inline void forget_questions(wire::Query& copy) {
  using wire_contract::QuestionKind;
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                  QuestionKind::sweep, QuestionKind::inside}) {
    for (const wire::Column<wire::Query>& column : wire::question_columns(kind)) copy.*column.sequence = {};
  }
}

template <class Message>
std::vector<double> rows_of(const Message& message, wire::Columns<Message> columns) {
  std::vector<double> rows;
  wire::gather_rows(message, columns, rows);
  return rows;
}
inline std::vector<double> hits_of(const wire::Reply& reply) { return rows_of(reply, wire::hit_columns(reply)); }
inline std::vector<double> poses_of(const wire::PoseBatch& batch) {
  return rows_of<wire::PoseBatch>(batch, wire::kPoseColumns);
}

}  // namespace collided::test
