#pragma once

#include <cstdint>
#include <vector>

#include "idl/messages.hpp"
#include "server/service/events/frames.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

/// Their memory is reused from reply to reply. A hit has either distances, their errors and exits or the sweep's three
/// columns; the others stay empty.
using wire::ReplyColumns;

/// Fills replies from a chunk's answers, as many as its hits need: a reply stays within kMaxHitsPerChunk and
/// kMaxMessageBytes. Hits that do not fit even into a reply of their own are left out, and that answer becomes
/// undecided (truncated).
///
///   ReplyFiller filler(snapshot, answers);
///   while (filler.fill(columns)) write(columns, filler.first());
class ReplyFiller {
 public:
  /// named_in      memory of the caller: by slot, the number of the reply that named the object last
  /// reply_number  counts replies over all fillers that share named_in
  ReplyFiller(const Snapshot& snapshot, const Answers& answers, std::vector<std::uint64_t>& named_in,
              std::uint64_t& reply_number)
      : snapshot_(snapshot), answers_(answers), named_in_(named_in), reply_number_(reply_number) {}

  /// Fills `columns` with the next reply; false when all answers are in replies.
  bool fill(ReplyColumns& columns);
  /// The reply filled last is the last one.
  bool is_done() const { return question_ >= answers_.answers.size(); }
  /// The first question of the reply filled last, within the chunk.
  std::size_t first() const { return first_; }
  /// Undecided answers so far.
  std::uint64_t undecided() const { return undecided_; }

 private:
  void start(ReplyColumns& columns);
  bool add_question(ReplyColumns& columns);
  /// The next question has an entry in Answers::not_covered.
  bool leaves_covered() const;
  std::size_t bytes_of(const AnswerHit& hit);
  void add_hit(std::size_t index, ReplyColumns& columns);
  void add_not_covered(bool is_cut, ReplyColumns& columns);
  const ObjectInfo* info_of(ObjectId id) const;
  std::string_view name_of(ObjectId id) const;

  const Snapshot& snapshot_;
  const Answers& answers_;
  std::vector<std::uint64_t>& named_in_;
  std::uint64_t& reply_number_;
  std::size_t first_ = 0;        // first question of this reply
  std::size_t question_ = 0;     // the next one
  std::size_t hit_ = 0;          // its first hit
  std::size_t not_covered_ = 0;  // the next of those
  std::size_t bytes_ = 0;        // of this reply so far
  std::uint64_t undecided_ = 0;
};

}  // namespace collided::engine::service
