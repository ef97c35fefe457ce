#include "server/service/fleet/change_follower.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "idl/clocks.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

/// After this long without all that is kept it is asked for again: the primary may not have known this reader yet.
constexpr std::int64_t kFetchPatienceNs = 3'000'000'000;
/// What a change needs may still be on its way from a publisher.
constexpr std::int64_t kRetryForNs = 3'000'000'000;
constexpr std::size_t kMostAlarms = 8;
/// A primary that is there and can send it has done so by then.
constexpr std::uint64_t kFetchesInVain = 3;

}  // namespace

ChangeFollower::ChangeFollower(const dds::Participant& participant, std::uint64_t self, const std::string& name_space,
                               Collaborators with)
    : self_(self), with_(std::move(with)), topic_(participant, name_space), reader_(topic_), waitset_(participant) {
  waitset_.attach(reader_, 1);
  thread_ = named_thread("follower", [this] { run(); });
}

ChangeFollower::~ChangeFollower() {
  is_over_.store(true);
  waitset_.wake();
  thread_.join();
}

void ChangeFollower::follow(std::uint64_t primary, const std::string& name) {
  if (primary_.load() != 0) return;
  {
    const std::lock_guard lock(mutex_);
    primary_name_ = name;
  }
  fetch_.store(1);
  primary_.store(primary);
  waitset_.wake();
}

std::vector<std::string> ChangeFollower::alarms() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> all = alarms_;
  if (!is_whole_.load() && fetch_.load() > kFetchesInVain)
    all.push_back(fmt::format(
        "'{}' does not send what it keeps: it needs a state folder, and its log says what is wrong", primary_name_));
  return all;
}

void ChangeFollower::raise(std::string sentence) {
  with_.notice(sentence);
  const std::lock_guard lock(mutex_);
  if (alarms_.size() < kMostAlarms) alarms_.push_back(std::move(sentence));
}

void ChangeFollower::run() {
  constexpr std::int64_t kLookNs = 500'000'000;
  while (!is_over_.load()) {
    waitset_.wait(kLookNs);
    take();
    if (primary_.load() == 0 || is_whole_.load()) continue;
    if (asked_ns_ == 0) asked_ns_ = wire_contract::steady_ns();
    if (wire_contract::steady_ns() - asked_ns_ < kFetchPatienceNs) continue;
    fetch_.fetch_add(1);
    asked_ns_ = wire_contract::steady_ns();
  }
}

void ChangeFollower::take() {
  while (!is_over_.load() && reader_.take(sample_)) {
    if (!sample_.info().valid_data || sample_->server != primary_.load()) continue;
    if (sample_->follower == self_) take_fetched();
    if (sample_->follower == 0) take_live();
  }
}

/// Nothing is carried out before all is there: what is missing in the middle could not be added later.
void ChangeFollower::take_fetched() {
  if (is_whole_.load() || sample_->fetch != fetch_.load()) return;
  const bool is_first = fetched_.empty();
  if (!is_first && sample_->left != expected_left_) {
    fetched_.clear();
    fetch_.fetch_add(1);
    asked_ns_ = wire_contract::steady_ns();
    return;
  }
  const auto blob = std::as_bytes(dds::view(sample_->blob));
  fetched_.push_back({.text = sample_->text, .blob = {blob.begin(), blob.end()}});
  expected_left_ = sample_->left - 1;
  asked_ns_ = wire_contract::steady_ns();
  if (sample_->left != 0) return;
  last_sequence_ = sample_->sequence_number;
  for (const WorldChange& change : std::exchange(fetched_, {})) carry_out(change);
  is_whole_.store(true);
}

void ChangeFollower::take_live() {
  if (!is_whole_.load()) return;  // what is fetched has it
  if (sample_->sequence_number <= last_sequence_) return;
  if (sample_->sequence_number != last_sequence_ + 1) {
    raise(fmt::format("{} changes of the primary were lost; start this server again",
                      sample_->sequence_number - last_sequence_ - 1));
  }
  last_sequence_ = sample_->sequence_number;
  const auto blob = std::as_bytes(dds::view(sample_->blob));
  carry_out({.text = sample_->text, .blob = {blob.begin(), blob.end()}});
}

void ChangeFollower::carry_out(const WorldChange& change) {
  if (change.text.empty()) return;
  const std::int64_t until_ns = wire_contract::steady_ns() + kRetryForNs;
  std::string refusal = with_.carry_out(change);
  while (!refusal.empty() && !is_over_.load() && wire_contract::steady_ns() < until_ns) {
    constexpr std::chrono::milliseconds kPause{50};
    std::this_thread::sleep_for(kPause);
    refusal = with_.carry_out(change);
  }
  constexpr std::size_t kMostWords = 200;
  if (!refusal.empty() && !is_over_.load())
    raise(fmt::format("what the primary did cannot be done here: {}: {}", change.text.substr(0, kMostWords), refusal));
}

}  // namespace collided::engine::service
