#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "client/library/c/options.hpp"

using namespace collided;
using namespace collided::c;

/// Answers, with the number of each question's first hit.
struct collided_answers {
  Answers answers;
  std::vector<std::size_t> first_hit;  // number of each question's first hit; the last entry is the number of all hits

  void take(Answers&& given) {
    answers = std::move(given);
    first_hit.assign(1, 0);
    first_hit.reserve(answers.answers.size() + 1);
    for (const Answer& answer : answers.answers) first_hit.push_back(first_hit.back() + answer.hits.size());
  }
};

namespace {

template <std::size_t kWidth, class Make>
auto questions_of(const double* rows, std::size_t count, const Make& make) {
  std::vector<decltype(make(rows))> questions;
  questions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) questions.push_back(make(rows + kWidth * i));
  return questions;
}

/// The rows as questions, of which they have the layout: nothing is copied.
template <class Q>
std::span<const Q> laid_out(const double* rows, std::size_t count) {
  static_assert(std::is_standard_layout_v<Q> && alignof(Q) == alignof(double));
  return {reinterpret_cast<const Q*>(rows), count};
}
static_assert(sizeof(RayQuestion) == 7 * sizeof(double) && offsetof(RayQuestion, length_m) == 6 * sizeof(double));
static_assert(sizeof(SphereQuestion) == 4 * sizeof(double) && offsetof(SphereQuestion, radius_m) == 3 * sizeof(double));
static_assert(sizeof(NearQuestion) == 4 * sizeof(double) && offsetof(NearQuestion, within_m) == 3 * sizeof(double));
static_assert(sizeof(InsideQuestion) == 3 * sizeof(double));

/// Asks the questions. The memory of earlier answers is used again.
template <class Questions>
Result<void> ask_all(collided_client* client, const Questions& questions, const collided_ask_options* options,
                     collided_answers** answers) {
  std::unique_ptr<collided_answers> kept(std::exchange(*answers, nullptr));
  if (!kept) kept = std::make_unique<collided_answers>();
  Result<Answers> said = client->client.ask(questions, ask_options(options), std::move(kept->answers));
  if (!said) return said.error();
  kept->take(std::move(*said));
  *answers = kept.release();
  return {};
}

Pose pose_in(const double* numbers) { return {.position = vector(numbers), .rotation = rotation(numbers + 3)}; }

/// Asks what the shape of the options meets on each motion. The memory of earlier answers is given back.
Result<void> ask_sweeps(collided_client* client, const double* rows, std::size_t count,
                        const collided_ask_options* options, collided_answers** answers) {
  const collided_ask_options given = taken(options);
  const Result<Shape> shape = shape_of(given.shape, given.shape_parts);
  if (!shape) return shape.error();
  const std::vector<SweepQuestion> motions = questions_of<14>(
      rows, count, [](const double* row) { return SweepQuestion{.from = pose_in(row), .to = pose_in(row + 7)}; });
  delete std::exchange(*answers, nullptr);
  Result<Answers> said = client->client.sweep(*shape, motions, ask_options(options));
  if (!said) return said.error();
  auto kept = std::make_unique<collided_answers>();
  kept->take(std::move(*said));
  *answers = kept.release();
  return {};
}

/// Writes the columns of one hit.
void put_hit(const collided_columns& to, std::size_t at, const Hit& hit) {
  if (to.object_id) to.object_id[at] = hit.object_id;
  if (to.triangle) to.triangle[at] = hit.triangle;
  if (to.distance_m) to.distance_m[at] = hit.distance_m;
  if (to.error_m) to.error_m[at] = hit.error_m;
  if (to.exit_m) to.exit_m[at] = hit.exit_m;
  if (to.point) put(hit.point, to.point + 3 * at);
  if (to.point_error_m) to.point_error_m[at] = hit.point_error_m;
  if (to.normal) put(hit.normal, to.normal + 3 * at);
  if (to.weights) put(hit.weights, to.weights + 3 * at);
  if (to.time_low) to.time_low[at] = hit.time_low;
  if (to.time_high) to.time_high[at] = hit.time_high;
  if (to.inside) to.inside[at] = static_cast<std::uint8_t>(hit.by_winding ? 2 : hit.inside ? 1 : 0);
  if (to.stale) to.stale[at] = hit.stale ? 1 : 0;
  if (to.by_winding) to.by_winding[at] = hit.by_winding ? 1 : 0;
}

/// Writes the columns of one question.
void put_answer(const collided_columns& to, std::size_t at, const Answer& answer) {
  if (to.verdict) to.verdict[at] = static_cast<std::uint8_t>(answer.verdict);
  if (to.reason) to.reason[at] = static_cast<std::uint8_t>(answer.reason);
  if (to.hit_count) to.hit_count[at] = static_cast<std::uint32_t>(answer.hits.size());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const Uncovered nowhere{.point = Vec3::Constant(kNone), .covered_m = kNone};
  const Uncovered uncovered = answer.uncovered.value_or(nowhere);
  if (to.uncovered) put(uncovered.point, to.uncovered + 3 * at);
  if (to.covered_m) to.covered_m[at] = uncovered.covered_m;
}

Hit no_hit() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Hit hit;
  hit.distance_m = hit.error_m = hit.exit_m = hit.point_error_m = hit.time_low = hit.time_high = kNone;
  hit.point = hit.normal = hit.weights = Vec3::Constant(kNone);
  return hit;
}

// ---- configurations ------------------------------------------------------------------------------------------------

/// Adds the two hits by which collided.h reports a pair.
void put_pair(const ClearancePair& pair, Answer& answer) {
  Hit& a = answer.hits.emplace_back();
  a.object = pair.a;
  a.object_id = pair.a_id;
  a.triangle = pair.a_triangle;
  a.distance_m = pair.clearance_m;
  a.error_m = pair.error_m;
  a.point = pair.on_a;
  a.point_error_m = pair.point_error_m;
  a.normal = pair.normal;
  a.inside = pair.contained == Containment::a_in_b;
  a.stale = pair.stale;
  Hit b = a;
  b.object = pair.b;
  b.object_id = pair.b_id;
  b.triangle = pair.b_triangle;
  b.point = pair.on_b;
  b.inside = pair.contained == Containment::b_in_a;
  answer.hits.push_back(std::move(b));
}

Answers what_if_answers(const WhatIfAnswers& said) {
  Answers made;
  made.version = said.version;
  made.world_time = said.world_time;
  made.compute = said.compute;
  for (const ConfigurationAnswer& one : said.configurations) {
    Answer& answer = made.answers.emplace_back();
    answer.verdict = one.verdict;
    answer.reason = one.reason;
    if (one.nearest) put_pair(*one.nearest, answer);
  }
  return made;
}

/// collided_ask_options have a different default timeout.
WhatIfOptions what_if_options(const collided_ask_options* options, const ImaginedObjects& imagined) {
  const AskOptions asked = ask_options(options);
  WhatIfOptions how{.against = asked.only,
                    .skip = asked.skip,
                    .mask = asked.mask,
                    .with_clearance = asked.mode != HitMode::any,
                    .nearer_m = imagined.nearer_m,
                    .with_filtered = imagined.with_filtered,
                    .as_of = asked.as_of,
                    .importance = asked.importance,
                    .fresh = asked.fresh,
                    .deadline = asked.deadline};
  if (taken(options).timeout_ns != 0) how.timeout = asked.timeout;
  for (const std::vector<std::string>& pair : imagined.attached) how.attached.emplace_back(pair.front(), pair.back());
  return how;
}

}  // namespace

extern "C" {

int collided_ask(collided_client* client, collided_question kind, const double* rows, size_t count,
                 const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!answers) return missing("answers");
    if (count > 0 && !rows) return missing("an array of numbers");
    const auto ask = [&](const auto& questions) { return ask_all(client, questions, options, answers); };
    switch (kind) {
      case COLLIDED_ASK_RAYS: return ask(laid_out<RayQuestion>(rows, count));
      case COLLIDED_ASK_SPHERES: return ask(laid_out<SphereQuestion>(rows, count));
      case COLLIDED_ASK_BOXES:
        return ask(questions_of<10>(rows, count, [](const double* row) {
          return BoxQuestion{.center = vector(row), .half_m = vector(row + 3), .rotation = rotation(row + 6)};
        }));
      case COLLIDED_ASK_NEAREST: return ask(laid_out<NearQuestion>(rows, count));
      case COLLIDED_ASK_INSIDE: return ask(laid_out<InsideQuestion>(rows, count));
      case COLLIDED_ASK_SWEEPS: return ask_sweeps(client, rows, count, options, answers);
      default: return unknown_kind("question", kind, 5);
    }
  });
}

int collided_what_if(collided_client* client, const char* objects, const double* poses, size_t count,
                     const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!answers) return missing("answers");
    Result<ImaginedObjects> imagined = options_of<ImaginedObjects>(objects, "what-if");
    if (!imagined) return imagined.error();
    if (count * imagined->objects.size() > 0 && !poses) return missing("an array of numbers");
    for (const std::vector<std::string>& pair : imagined->attached) {
      if (pair.size() != 2)
        return Error{ErrorCode::bad_input, "what-if: attached: " + std::to_string(pair.size()) + " names; allowed 2",
                     "nothing was sent"};
    }
    const WhatIfOptions how = what_if_options(options, *imagined);
    WhatIfConfigurations made{.objects = std::move(imagined->objects), .poses = {}};
    for (std::size_t i = 0; i < count * made.objects.size(); ++i) made.poses.push_back(pose_in(poses + 7 * i));
    delete std::exchange(*answers, nullptr);
    const Result<WhatIfAnswers> said = client->client.what_if(made, how);
    if (!said) return said.error();
    auto kept = std::make_unique<collided_answers>();
    kept->take(what_if_answers(*said));
    *answers = kept.release();
    return {};
  });
}

void collided_free_answers(collided_answers* answers) { delete answers; }

void collided_get_info(const collided_answers* answers, collided_answers_info* info) {
  if (!answers) return;
  const Answers& said = answers->answers;
  collided_answers_info told{};
  told.has_oldest_pose = said.oldest_pose_age ? 1 : 0;
  told.questions = said.answers.size();
  told.hits = answers->first_hit.back();
  told.epoch = said.epoch;
  told.version = said.version;
  told.world_time_ns = said.world_time.count();
  told.oldest_pose_age_ns = said.oldest_pose_age.value_or(std::chrono::nanoseconds(0)).count();
  told.compute_ns = said.compute.count();
  give(told, info);
}

void collided_read_columns(const collided_answers* answers, const collided_columns* columns) {
  if (!answers) return;
  const collided_columns to = taken(columns);
  const Hit none = no_hit();
  std::size_t at = 0;
  for (std::size_t i = 0; i < answers->answers.answers.size(); ++i) {
    const Answer& answer = answers->answers.answers[i];
    put_answer(to, i, answer);
    if (to.first_hits) {
      put_hit(to, i, answer.hits.empty() ? none : answer.hits.front());
      continue;
    }
    for (const Hit& hit : answer.hits) put_hit(to, at++, hit);
  }
}

const char* collided_hit_object(const collided_answers* answers, size_t hit) {
  if (!answers || hit >= answers->first_hit.back()) return nullptr;
  const auto after = std::upper_bound(answers->first_hit.begin(), answers->first_hit.end(), hit);
  const auto question = static_cast<std::size_t>(after - answers->first_hit.begin()) - 1;
  return answers->answers.answers[question].hits[hit - answers->first_hit[question]].object.c_str();
}

}  // extern "C"
