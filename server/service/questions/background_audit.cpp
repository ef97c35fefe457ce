#include "server/service/questions/background_audit.hpp"

#include <algorithm>
#include <utility>

#include "idl/topics.hpp"
#include "server/service/questions/time_slice.hpp"
#include "server/service/runtime/named_thread.hpp"
#include "server/world/audit/audit.hpp"

namespace collided::engine::service {

BackgroundAudit::BackgroundAudit(std::uint64_t every, std::function<void(const std::string&)> notice, bool asks_fcl)
    : every_(every), notice_(std::move(notice)), asks_fcl_(asks_fcl) {
  if (every_ > 0) thread_ = named_thread("audit", [this] { run(); });
}

BackgroundAudit::~BackgroundAudit() { stop(); }

void BackgroundAudit::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BackgroundAudit::consider(const SnapshotRing::Lease& state, const Questions& asked, const Answers& given) {
  if (every_ == 0) return;
  const std::uint64_t count = given.answers.size();
  const std::uint64_t first = considered_.fetch_add(count, std::memory_order_relaxed);
  // The very first answer is chosen, then one in every `every_`.
  std::uint64_t next = (every_ - first % every_) % every_;
  if (next >= count) return;
  std::size_t hit = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i == next) {
      choose(state, asked, given, i, hit);
      next += every_;
    }
    hit += given.hit_counts[i];
  }
}

void BackgroundAudit::choose(const SnapshotRing::Lease& state, const Questions& asked, const Answers& given,
                             std::size_t index, std::size_t first_hit) {
  auto item = std::make_unique<Item>();
  item->question = asked;
  item->only = asked.only;
  item->skip = asked.skip;
  const std::size_t stride = asked.numbers.size() / given.answers.size();
  const std::span<const double> numbers = asked.numbers.subspan(index * stride, stride);
  item->numbers.assign(numbers.begin(), numbers.end());
  item->given.answers = {given.answers[index]};
  item->given.reasons = {given.reasons[index]};
  const auto hits = given.hits.begin() + static_cast<std::ptrdiff_t>(first_hit);
  item->given.hits.assign(hits, hits + static_cast<std::ptrdiff_t>(given.hit_counts[index]));
  item->question.only = item->only;
  item->question.skip = item->skip;
  item->question.numbers = item->numbers;
  {
    const std::lock_guard lock(mutex_);
    ++counts_.chosen;
    if (waiting_.size() < kMostWaiting) item->state = pin(state);
    if (!item->state) {
      ++counts_.skipped;
      return;
    }
    waiting_.push_back(std::move(item));
  }
  arrived_.notify_one();
}

/// Returns the state, kept alive once for all its waiting answers; null if kMostStates others are kept already.
std::shared_ptr<const BackgroundAudit::Pinned> BackgroundAudit::pin(const SnapshotRing::Lease& state) {
  std::erase_if(pinned_, [](const auto& held) { return held.expired(); });
  for (const auto& held : pinned_) {
    std::shared_ptr<const Pinned> pinned = held.lock();
    if (pinned && pinned->version == state->version) return pinned;
  }
  if (pinned_.size() >= kMostStates) return nullptr;
  auto pinned = std::make_shared<const Pinned>(Pinned{state->version, state});
  pinned_.push_back(pinned);
  return pinned;
}

void BackgroundAudit::run() {
  set_time_slice(kLongSlice);
  for (;;) {
    std::unique_ptr<Item> item;
    {
      std::unique_lock lock(mutex_);
      arrived_.wait(lock, [&] { return stopping_ || !waiting_.empty(); });
      if (stopping_) return;
      item = std::move(waiting_.front());
      waiting_.pop_front();
    }
    work_out(*item);
  }
}

void BackgroundAudit::work_out(const Item& item) {
  const std::string difference = audit(*item.state->lease, item.question, item.given);
  // Before it counts as audited: once the counts have reached a number, all opinions up to it are included.
  if (asks_fcl_) ask_fcl(item);
  {
    const std::lock_guard lock(mutex_);
    ++counts_.audited;
    if (!difference.empty()) ++counts_.differing;
  }
  if (!difference.empty()) tell(item, difference);
}

void BackgroundAudit::ask_fcl(const Item& item) {
  const Opinion opinion =
      fcl_opinion(*item.state->lease, item.question, item.given, [this] { return stopping_.load(); });
  {
    const std::lock_guard lock(mutex_);
    count(opinion.verdict, counts_.opinion);
  }
  if (opinion.verdict != OpinionVerdict::differ) return;
  std::string numbers;
  for (const double number : item.numbers) numbers += ' ' + std::to_string(number);
  tell(item, std::string(name_of(item.question.kind)) + numbers + ": FCL says " +
                 (*opinion.touches ? "that something is touched, answered was a miss"
                                   : "that nothing is touched, answered was a hit"));
}

void BackgroundAudit::tell(const Item& item, const std::string& difference) {
  {
    const std::lock_guard lock(mutex_);
    if (differences_.size() >= kMostReported) return;
    differences_.push_back(difference);
  }
  notice_("audit: an answer of world " + std::to_string(item.state->version) + " differs: " + difference);
}

AuditCounts BackgroundAudit::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::vector<std::string> BackgroundAudit::differences() const {
  const std::lock_guard lock(mutex_);
  return differences_;
}

}  // namespace collided::engine::service
