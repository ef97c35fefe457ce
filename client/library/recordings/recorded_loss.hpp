#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "client/library/connection/server_pulse.hpp"

namespace collided::client {

/// Counts the samples that a reader of all topics has missed, by their numbers: publishers number their messages, the
/// server its events; every reply belongs to a question and every question has a reply.
///
/// limits   publishers, servers and requests beyond kMost each are ignored
/// threads  one at a time
class RecordedLoss {
 public:
  static constexpr std::size_t kMost = 100'000;

  void hear_definition(std::uint64_t publisher, std::uint64_t incarnation, std::uint64_t sequence);
  void hear_poses(std::uint64_t publisher, std::uint64_t incarnation, std::uint64_t sequence);
  void hear_events(std::uint64_t server, std::uint64_t epoch, std::uint64_t first, std::uint64_t count);
  void hear_question(std::uint64_t client, std::uint64_t request, Clock::time_point now);
  void hear_reply(std::uint64_t client, std::uint64_t request, Clock::time_point now);
  /// Counts the requests whose other half can no longer come. Call it regularly, and at the end with `all`.
  void settle(Clock::time_point now, bool all = false);

  /// Lost definitions and pose batches together.
  std::uint64_t poses() const;
  std::uint64_t events() const { return events_; }
  std::uint64_t questions() const { return questions_; }
  /// Requests without a reply: it was lost, or never sent.
  std::uint64_t unanswered() const { return unanswered_; }

 private:
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  // The numbers of one publisher that were received.
  struct Series {
    bool began = false;  // its first pose batch has come; earlier messages arrive late, twice and with gaps
    std::uint64_t first = 0, last = 0, heard = 0;
  };
  // The received halves of a request, and the time of the first.
  struct Request {
    bool question = false, reply = false;
    Clock::time_point since;
  };
  Request* request(std::uint64_t client, std::uint64_t number, Clock::time_point now);
  Series* series(std::uint64_t publisher, std::uint64_t incarnation);

  std::map<Pair, Series> publishers_;
  std::map<Pair, std::uint64_t> next_event_;
  std::map<Pair, Request> requests_;
  std::uint64_t events_ = 0, questions_ = 0, unanswered_ = 0;
};

}  // namespace collided::client
