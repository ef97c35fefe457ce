#include "server/fleet/change_follower.hpp"

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
/// What a primary said last before it died may still be on its way while its heir speaks already.
constexpr std::int64_t kHeirPatienceNs = 1'000'000'000;
/// Changes of servers that are not followed yet: what is lost of them shows in the numbers.
constexpr std::size_t kMostEarly = 16;

}  // namespace

ChangeFollower::ChangeFollower(const dds::Participant& participant, std::uint64_t self, const std::string& name_space,
                               Collaborators with)
    : self_(self), with_(std::move(with)), topic_(participant, name_space), reader_(topic_), waitset_(participant) {
  waitset_.attach(reader_, 1);
  thread_ = named_thread("follower", [this] { run(); });
}

ChangeFollower::~ChangeFollower() { leave(); }

void ChangeFollower::leave() {
  give_up();
  waitset_.wake();
  if (thread_.joinable()) thread_.join();
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

bool ChangeFollower::follow_heir(std::uint64_t heir, const std::string& name, std::uint64_t carried_out) {
  {
    const std::lock_guard lock(mutex_);
    if (!alarms_.empty()) return false;
    if (!heir_ || heir_->server != heir)
      heir_ = {.server = heir, .name = name, .carried_out = carried_out, .heard_ns = wire_contract::steady_ns()};
    const bool is_ahead = is_whole_.load() && last_sequence_.load() > carried_out;
    if (is_ahead || wire_contract::steady_ns() - heir_->heard_ns > kHeirPatienceNs) return false;
  }
  waitset_.wake();
  return true;
}

std::vector<std::string> ChangeFollower::alarms() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> all = alarms_;
  if (!is_whole_.load() && fetch_.load() > kFetchesInVain)
    all.push_back(fmt::format(
        "'{}' does not send what it keeps: it needs a state folder, and its log says what is wrong", primary_name_));
  return all;
}

bool ChangeFollower::has_carried_out_lately() const {
  // Worlds are compared some seconds after the instant that is compared.
  constexpr std::int64_t kLatelyNs = 10'000'000'000;
  const std::int64_t last_ns = carried_out_ns_.load();
  return last_ns != 0 && wire_contract::steady_ns() - last_ns < kLatelyNs;
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
    turn_to_heir();
    if (primary_.load() == 0 || is_whole_.load()) continue;
    if (asked_ns_ == 0) asked_ns_ = wire_contract::steady_ns();
    if (wire_contract::steady_ns() - asked_ns_ < kFetchPatienceNs) continue;
    fetch_.fetch_add(1);
    asked_ns_ = wire_contract::steady_ns();
  }
}

void ChangeFollower::take() {
  while (!is_over_.load() && reader_.take(sample_)) {
    if (!sample_.info().valid_data) continue;
    if (sample_->server != primary_.load()) {
      keep_early();
    } else if (sample_->follower == self_) {
      take_fetched();
    } else if (sample_->follower == 0) {
      take_live();
    }
  }
}

/// That a server has taken the primary's place may be heard after what it changed since.
void ChangeFollower::keep_early() {
  if (sample_->follower != 0) return;
  const auto blob = std::as_bytes(dds::view(sample_->blob));
  early_.push_back({.server = sample_->server,
                    .sequence = sample_->sequence_number,
                    .change = {.text = sample_->text, .blob = {blob.begin(), blob.end()}}});
  if (early_.size() > kMostEarly) early_.pop_front();
}

void ChangeFollower::turn_to_heir() {
  std::uint64_t heir = 0;
  {
    const std::lock_guard lock(mutex_);
    const bool is_done = !heir_ || (is_whole_.load() && last_sequence_.load() != heir_->carried_out);
    if (is_done) return;
    heir = heir_->server;
    primary_name_ = heir_->name;
    heir_.reset();
  }
  primary_.store(heir);
  if (!is_whole_.load()) {
    fetched_.clear();
    fetch_.fetch_add(1);
    asked_ns_ = wire_contract::steady_ns();
  }
  for (const EarlyChange& early : std::exchange(early_, {})) {
    if (early.server == heir) carry_out_next(early.sequence, early.change);
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
  last_sequence_.store(sample_->sequence_number);
  for (const WorldChange& change : std::exchange(fetched_, {})) carry_out(change);
  is_whole_.store(true);
}

void ChangeFollower::take_live() {
  const auto blob = std::as_bytes(dds::view(sample_->blob));
  carry_out_next(sample_->sequence_number, {.text = sample_->text, .blob = {blob.begin(), blob.end()}});
}

void ChangeFollower::carry_out_next(std::uint64_t sequence, const WorldChange& change) {
  if (!is_whole_.load()) return;  // what is fetched has it
  const std::uint64_t last = last_sequence_.load();
  if (sequence <= last) return;
  if (sequence != last + 1)
    raise(fmt::format("{} changes of the primary were lost; start this server again", sequence - last - 1));
  last_sequence_.store(sequence);
  carry_out(change);
}

void ChangeFollower::carry_out(const WorldChange& change) {
  if (change.text.empty()) return;
  carried_out_ns_.store(wire_contract::steady_ns());
  const std::int64_t until_ns = carried_out_ns_.load() + kRetryForNs;
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
