#include "server/service/questions/question_samples.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string_view>

namespace collided::engine::service {
namespace {

std::string_view name_in(const Snapshot& state, ObjectId id) {
  const std::uint32_t slot = slot_of(id);
  if (slot >= state.objects.size() || !state.objects[slot]) return {};
  return state.objects[slot]->name;
}

}  // namespace

void QuestionSamples::take(const Snapshot& state, const Questions& asked, const Answers& given, std::uint64_t client,
                           std::int64_t taken_ns) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || !wants(taken_ns)) return;
  const bool is_read = taken_ns - read_ns_ <= kReaderNs;
  next_ns_.store(is_read ? taken_ns + kPauseNs : kNever, std::memory_order_relaxed);
  if (!is_read) return;
  const std::size_t index = static_cast<std::size_t>(taken_ns) % given.answers.size();
  SampledQuestion& sample = (*kept_)[count_ % kKept];
  sample.sequence = ++count_;
  sample.client = client;
  sample.taken_ns = taken_ns;
  sample.kind = asked.kind;
  const std::size_t stride = engine::numbers_of(asked.kind);
  std::ranges::copy(asked.numbers.subspan(index * stride, stride), sample.numbers.begin());
  sample.verdict = given.answers[index];
  sample.has_hit = given.hit_counts[index] > 0;
  sample.object.fill('\0');
  if (!sample.has_hit) return;
  const std::span<const std::uint32_t> before = std::span(given.hit_counts).first(index);
  sample.hit = given.hits[std::accumulate(before.begin(), before.end(), std::size_t{0})];
  const std::string_view name = name_in(state, sample.hit.object).substr(0, wire_contract::kMaxNameBytes);
  std::ranges::copy(name, sample.object.begin());
}

std::vector<SampledQuestion> QuestionSamples::read(std::uint64_t since, std::uint64_t reader, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  if (!kept_) kept_ = std::make_unique<std::array<SampledQuestion, kKept>>();
  read_ns_ = now_ns;
  if (next_ns_.load(std::memory_order_relaxed) == kNever) next_ns_.store(now_ns, std::memory_order_relaxed);
  std::vector<SampledQuestion> samples;
  const std::uint64_t oldest = count_ > kKept ? count_ - kKept : 0;
  if (since > count_) since = 0;  // counted by another server, before a restart
  for (std::uint64_t number = std::max(since, oldest); number < count_; ++number) {
    const SampledQuestion& sample = (*kept_)[number % kKept];
    if (sample.client != reader) samples.push_back(sample);
  }
  return samples;
}

}  // namespace collided::engine::service
