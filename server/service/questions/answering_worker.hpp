#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/reply_columns.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

/// Answers on one thread, and reuses its memory from answer to answer.
class Answering::Worker {
 public:
  /// patience_ns  time for one question before it is passed to the threads for costly ones; 0: this is one of these
  Worker(Answering& owner, std::int64_t patience_ns) : owner_(owner), patience_ns_(patience_ns) {
    reply_->server = owner.options_.server;
    text_.reserve(out_of_memory_.size());  // so that a refusal for lack of memory needs none
  }
  /// Processes the queue until it is closed and empty.
  void run();
  void run_costly();
  /// Answers, or answers the next questions of a chunk that takes longer than its turn. Answers none if the first one
  /// takes longer than this worker has, or if no client waits for the answer any more.
  ///
  /// returns  whether all of it is answered now
  bool answer(Client& client, Ask& ask);

 private:
  void work(AskPointer ask);
  void work(TextReply text);
  void work(Farewell farewell);
  void work(Resume resume);
  void work(ExpireLeases gone);
  void answer_or_throw(Client& client, Ask& ask);
  void answer_sweeps(Client& client, Ask& ask);
  void answer_configurations(Client& client, Ask& ask);
  std::int64_t deadline_of(const Ask& ask) const;
  bool is_unfinished(const Client& client, std::size_t count);
  SearchTime time_for(const Client& client, const Ask& ask) const;
  void answer_questions(Client& client, Ask& ask, const ObjectInfo* mover);
  std::span<const double> rows_left(const Ask& ask) const;
  bool find_past(Client& client, Ask& ask, const Snapshot& newest);
  void doubt(const Questions& questions);
  void count_levels(QuestionKind kind);
  void count_answered(const Ask& ask, std::uint64_t undecided);
  void write_answers(Client& client, const Ask& ask, const Snapshot& snapshot);
  void write_text(Client& client, std::uint64_t request, wire_contract::ReplyStatus status, std::string_view text,
                  bool is_recorded = true);
  void command(const Ask& ask);
  void send(Client& client, bool is_recorded = true);

  Answering& owner_;
  const std::int64_t patience_ns_;
  dds::Sample<wire::Reply> reply_;
  ReplyColumns columns_;
  std::vector<std::uint8_t> text_;
  const std::string out_of_memory_ = refusal_text("not enough memory for the answer", "ask for less at a time");
  Answers answers_;
  QueryScratch scratch_;
  std::vector<double> numbers_;  // of the current questions, a row each
  bool is_paused_ = false;       // the current ask has questions left
  std::vector<std::uint64_t> named_in_;
  std::uint64_t reply_number_ = 0;
};

}  // namespace collided::engine::service
