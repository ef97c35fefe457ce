#include "server/world/query/question_batch.hpp"

#include <cmath>
#include <optional>

#include "idl/clocks.hpp"
#include "idl/question_rules.hpp"
#include "server/world/query/answer_writing.hpp"
#include "server/world/query/plain_rays.hpp"
#include "server/world/query/scene_walk.hpp"

namespace collided::engine {
namespace {

void ask(Question& question, const double* numbers) {
  switch (question.asked.kind) {
    case QuestionKind::ray: return ask_ray(question, numbers);
    case QuestionKind::sphere: return ask_sphere(question, numbers);
    case QuestionKind::box: return ask_box(question, numbers);
    case QuestionKind::near: return ask_near(question, numbers);
    case QuestionKind::sweep: return ask_sweep(question, numbers);
    case QuestionKind::inside: return ask_inside(question, numbers);
    default: return;
  }
}

/// Decides when a batch makes room for other requests. Reads the clock about once in 10 us of work.
class Pause {
 public:
  explicit Pause(std::int64_t at_ns) : at_ns_(at_ns) {}

  /// Call after the questions from `first` on were answered.
  bool is_due(const Answers& answers, std::size_t first, std::size_t count) {
    if (at_ns_ == 0) return false;
    for (std::size_t i = first; i < first + count; ++i) work_ += kQuestion + answers.nodes[i] + answers.exact_tests[i];
    if (work_ < kWorkAReading) return false;
    work_ = 0;
    return wire_contract::steady_ns() > at_ns_;
  }

 private:
  static constexpr std::uint64_t kQuestion = 32;  // in nodes
  static constexpr std::uint64_t kWorkAReading = 1'024;

  std::int64_t at_ns_ = 0;
  std::uint64_t work_ = 0;
};

}  // namespace

QuestionBatch::QuestionBatch(const Snapshot& snapshot, const Questions& asked, QueryScratch& scratch, Answers& answers)
    : snapshot_(snapshot),
      asked_(asked),
      scratch_(scratch),
      answers_(answers),
      stride_(engine::numbers_of(asked.kind)),
      is_plain_(are_plain_rays(snapshot, asked, scratch.filter())) {
  if (is_plain_ && scratch.plain_rays.empty()) {
    scratch.plain_rays.resize(kRaysAtOnce);
    scratch.ray_tasks.resize(kRaysAtOnce);
  }
}

std::size_t QuestionBatch::answer_all(std::size_t count) const {
  const bool together = rays_gain_together(count);
  const std::size_t step = together ? kRaysAtOnce : 1;
  Pause pause(asked_.pause_ns);
  for (std::size_t i = 0; i < count; i += step) {
    const std::size_t size = std::min(step, count - i);
    if (!together) {
      if (!answer_one(i)) return i;
    } else if (const std::size_t done = is_plain_ ? answer_plain_rays(i, size) : answer_rays(i, size); done < size) {
      return i + done;
    }
    if (pause.is_due(answers_, i, size)) return i + size;
  }
  return count;
}

/// Rays in unrelated directions through a tree larger than the caches mostly wait for memory: walked in turn, one uses
/// the waiting time of another. Rays like a camera's visit the same nodes, and gain from visiting them together if no
/// candidate needs to be filtered; otherwise each profits from the last one's cache content, and is faster alone.
bool QuestionBatch::rays_gain_together(std::size_t count) const {
  constexpr std::size_t kFewestTogether = 16;
  constexpr std::uint64_t kCacheBytes = 4 << 20;
  constexpr std::size_t stride = kRayNumbers;
  if (asked_.kind != QuestionKind::ray || asked_.mode == HitMode::all || count < kFewestTogether) return false;
  std::size_t alike = 0;
  for (std::size_t i = 1; i < kFewestTogether; ++i) {
    const double* a = asked_.numbers.data() + (i - 1) * stride;
    const double* b = a + stride;
    const bool same_start = a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
    const double along = a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
    const double squares = (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]) * (b[3] * b[3] + b[4] * b[4] + b[5] * b[5]);
    const bool same_direction = along > 0 && along * along > 0.99 * squares;
    alike += same_start && same_direction ? 1 : 0;
  }
  if (alike >= kFewestTogether / 2) {
    return !snapshot_.scenes.empty() && scratch_.filter().all_open && asked_.error_m == 0 &&
           asked_.highest == Level::rational;
  }
  std::uint64_t bytes = 0;
  for (const auto& scene : snapshot_.scenes) bytes += scene->tree.report().bytes;
  return bytes >= kCacheBytes;
}

bool QuestionBatch::answer_one(std::size_t place) const {
  return is_plain_ ? answer_plain_ray(place) : answer_in_general(place);
}

bool QuestionBatch::answer_in_general(std::size_t place) const {
  const double* numbers = numbers_of(place);
  if (const std::optional<Verdict> at_once = answer_at_once(asked_, numbers)) {
    write_at_once(answers_, place, *at_once);
    return true;
  }
  return answer_by(place, [&](Question& question) { ask(question, numbers); });
}

/// A single question writes its hits directly into the answers.
template <class Ask>
bool QuestionBatch::answer_by(std::size_t place, const Ask& ask_question) const {
  const SearchTime time{
      .deadline_ns = asked_.deadline_ns, .give_up_ns = asked_.give_up_ns, .called_off = asked_.called_off};
  Question question{.snapshot = snapshot_,
                    .asked = asked_,
                    .allowed = allowed(),
                    .open_scenes = scratch_.filter().open_scenes,
                    .found = asked_.numbers.size() == stride_ ? answers_.hits : scratch_.found,
                    .deadline = time.end()};
  ask_question(question);
  if (is_cut_short(question) && time.is_given_up()) {
    question.found.clear();
    return false;
  }
  write_answer(question, numbers_of(place), scratch_.filter(), place, answers_);
  return true;
}

bool QuestionBatch::answer_plain_ray(std::size_t place) const {
  const double* numbers = numbers_of(place);
  PlainRay& ray = scratch_.plain_rays.front();
  switch (engine::answer_plain_ray(snapshot_, asked_, numbers, allowed(), ray, place, answers_)) {
    case PlainOutcome::not_plain: return answer_in_general(place);
    case PlainOutcome::answered: return true;
    case PlainOutcome::reaches_movers: return answer_with_movers(place, ray);
  }
  return false;
}

/// Completes a plain ray after the walk through the scenes.
bool QuestionBatch::finish_plain_ray(std::size_t place, PlainRay& ray) const {
  if (reaches_movers(snapshot_, allowed(), ray)) return answer_with_movers(place, ray);
  write_plain_ray(snapshot_, asked_, ray, place, answers_);
  return true;
}

[[gnu::noinline]] bool QuestionBatch::answer_with_movers(std::size_t place, const PlainRay& ray) const {
  return answer_by(place, [&](Question& question) { ask_ray_of_movers(question, numbers_of(place), ray); });
}

std::size_t QuestionBatch::answer_plain_rays(std::size_t first, std::size_t count) const {
  std::vector<PlainRay>& rays = scratch_.plain_rays;
  std::array<PlainRay*, kRaysAtOnce> walked;
  std::array<bool, kRaysAtOnce> is_plain;
  std::size_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    is_plain[i] = start_plain_ray(numbers_of(first + i), rays[i]);
    if (is_plain[i]) walked[size++] = &rays[i];
  }
  walk_plain_rays(snapshot_, asked_, std::span(walked).first(size), scratch_.ray_tasks);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_answered = is_plain[i] ? finish_plain_ray(first + i, rays[i]) : answer_in_general(first + i);
    if (!is_answered) return i;
  }
  return count;
}

std::size_t QuestionBatch::answer_rays(std::size_t first, std::size_t count) const {
  std::array<std::optional<Question>, kRaysAtOnce> group;
  std::array<std::size_t, kRaysAtOnce> places;
  std::array<const double*, kRaysAtOnce> numbers;
  scratch_.found_by_ray.resize(kRaysAtOnce);
  std::size_t size = 0;
  for (std::size_t place = first; place < first + count; ++place) {
    numbers[size] = numbers_of(place);
    if (const std::optional<Verdict> at_once = answer_at_once(asked_, numbers[size])) {
      write_at_once(answers_, place, *at_once);
      continue;
    }
    group[size].emplace(Question{.snapshot = snapshot_,
                                 .asked = asked_,
                                 .allowed = allowed(),
                                 .open_scenes = scratch_.filter().open_scenes,
                                 .found = scratch_.found_by_ray[size],
                                 .deadline = Deadline(asked_.deadline_ns, asked_.called_off)});
    places[size++] = place;
  }
  if (size == 0) return count;
  ask_rays(std::span(group).first(size), std::span<const double* const>(numbers).first(size));
  for (std::size_t i = 0; i < size; ++i) write_answer(*group[i], numbers[i], scratch_.filter(), places[i], answers_);
  return count;
}

}  // namespace collided::engine
