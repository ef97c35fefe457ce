#include "client/library/recordings/recorded_loss.hpp"

#include <algorithm>

namespace collided::client {
namespace {

/// How long to wait for the other half of a request. Questions and replies come on two topics, either first, and some
/// commands take long.
constexpr std::chrono::seconds kQuestionPatience{5};
constexpr std::chrono::seconds kReplyPatience{60};

}  // namespace

RecordedLoss::Series* RecordedLoss::series(std::uint64_t publisher, std::uint64_t incarnation) {
  const auto found = publishers_.find({publisher, incarnation});
  if (found != publishers_.end()) return &found->second;
  return publishers_.size() < kMost ? &publishers_[{publisher, incarnation}] : nullptr;
}

void RecordedLoss::hear_definition(std::uint64_t publisher, std::uint64_t incarnation, std::uint64_t sequence) {
  Series* heard = series(publisher, incarnation);
  if (heard == nullptr || !heard->began || sequence <= heard->first) return;
  heard->last = std::max(heard->last, sequence);
  ++heard->heard;
}

void RecordedLoss::hear_poses(std::uint64_t publisher, std::uint64_t incarnation, std::uint64_t sequence) {
  Series* heard = series(publisher, incarnation);
  if (heard == nullptr) return;
  if (!heard->began) {
    *heard = {.began = true, .first = sequence, .last = sequence, .heard = 1};
  } else if (sequence > heard->first) {
    heard->last = std::max(heard->last, sequence);
    ++heard->heard;
  }
}

std::uint64_t RecordedLoss::poses() const {
  std::uint64_t lost = 0;
  for (const auto& [publisher, heard] : publishers_) {
    const std::uint64_t sent = heard.last - heard.first + 1;
    if (heard.began && sent > heard.heard) lost += sent - heard.heard;
  }
  return lost;
}

void RecordedLoss::hear_events(std::uint64_t server, std::uint64_t epoch, std::uint64_t first, std::uint64_t count) {
  const auto next = next_event_.find({server, epoch});
  if (next == next_event_.end() && next_event_.size() >= kMost) return;
  if (next != next_event_.end() && first > next->second) events_ += first - next->second;
  next_event_[{server, epoch}] = first + count;
}

RecordedLoss::Request* RecordedLoss::request(std::uint64_t client, std::uint64_t number, Clock::time_point now) {
  const auto found = requests_.find({client, number});
  if (found != requests_.end()) return &found->second;
  if (requests_.size() >= kMost) return nullptr;
  Request& made = requests_[{client, number}];
  made.since = now;
  return &made;
}

void RecordedLoss::hear_question(std::uint64_t client, std::uint64_t number, Clock::time_point now) {
  if (Request* heard = request(client, number, now)) heard->question = true;
}

void RecordedLoss::hear_reply(std::uint64_t client, std::uint64_t number, Clock::time_point now) {
  if (Request* heard = request(client, number, now)) heard->reply = true;
}

void RecordedLoss::settle(Clock::time_point now, bool all) {
  std::erase_if(requests_, [&](const auto& entry) {
    const Request& heard = entry.second;
    const Clock::duration age = now - heard.since;
    if (!all && age < (heard.reply ? kQuestionPatience : kReplyPatience)) return false;
    // At the end of the recording the other half may still be in flight.
    const bool had_time = age >= std::chrono::milliseconds(500);
    questions_ += had_time && !heard.question ? 1 : 0;
    unanswered_ += had_time && !heard.reply ? 1 : 0;
    return true;
  });
}

}  // namespace collided::client
