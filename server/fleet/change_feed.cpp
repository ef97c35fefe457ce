#include "server/fleet/change_feed.hpp"

#include <cstdint>
#include <span>
#include <utility>

namespace collided::engine::service {

ChangeFeed::ChangeFeed(const dds::Participant& participant, std::uint64_t server, const std::string& name_space)
    : topic_(participant, name_space), writer_(topic_), messages_(kMostWaiting) {
  sample_->server = server;
  messages_.serve("changes", [this](const FeedMessage& message) {
    write(message);
    if (message.follower == 0) waiting_.fetch_sub(1);
  });
}

ChangeFeed::~ChangeFeed() {
  is_over_.store(true);
  messages_.finish();
}

void ChangeFeed::continue_from(std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  last_sequence_ = sequence;
}

void ChangeFeed::tell(WorldChange change) {
  if (!is_followed()) return;
  const std::lock_guard lock(mutex_);
  ++last_sequence_;
  if (waiting_.load() >= kMostWaiting) return;
  waiting_.fetch_add(1);
  if (!messages_.push({.sequence_number = last_sequence_, .change = std::move(change)})) waiting_.fetch_sub(1);
}

void ChangeFeed::tell_all(std::uint64_t follower, std::uint64_t fetch, std::vector<WorldChange> kept) {
  const std::lock_guard lock(mutex_);
  // The last one has none left. Where nothing is kept it is an empty one.
  if (kept.empty()) kept.emplace_back();
  std::uint64_t left = kept.size();
  for (WorldChange& change : kept) {
    messages_.push({.follower = follower,
                    .fetch = fetch,
                    .sequence_number = last_sequence_,
                    .left = --left,
                    .change = std::move(change)});
  }
}

/// Tries again while somebody follows: a change that is left out would make the worlds differ.
void ChangeFeed::write(const FeedMessage& message) {
  sample_->follower = message.follower;
  sample_->fetch = message.fetch;
  sample_->sequence_number = message.sequence_number;
  sample_->left = message.left;
  // It came in such a field, so it fits.
  static_cast<void>(dds::set_text(sample_->text, message.change.text));
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(message.change.blob.data());
  dds::borrow(sample_->blob, std::span(bytes, message.change.blob.size()));
  try {
    while (!is_over_.load() && is_followed() && !writer_.write(*sample_)) {}
  } catch (const dds::DdsError&) {}  // the follower sees the gap
}

}  // namespace collided::engine::service
