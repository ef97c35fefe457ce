#include <cmath>
#include <limits>
#include <vector>

#include "client/library/c/answers.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

template <Question Q>
Result<void> ask(collided_client* client, const std::vector<Q>& questions, const collided_ask_options* options,
                 collided_answers** answers) {
  std::unique_ptr<collided_answers> kept(*answers);
  *answers = nullptr;
  if (!kept) kept = std::make_unique<collided_answers>();
  Result<Answers> said = client->client.ask(questions, ask_options(options), std::move(kept->answers));
  if (!said) return said.error();
  kept->take(std::move(*said));
  *answers = kept.release();
  return {};
}

/// Makes the questions by `make` and asks them.
template <class Make>
int ask_rows(collided_client* client, std::size_t count, bool has_rows, const Make& make,
             const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!answers) return missing("answers");
    if (count > 0 && !has_rows) return missing("an array of numbers");
    std::vector<decltype(make(0))> questions;
    questions.reserve(count);
    for (std::size_t i = 0; i < count; ++i) questions.push_back(make(i));
    return ask(client, questions, options, answers);
  });
}

/// Where the columns of one hit go.
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

/// The output columns of one question.
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

}  // namespace

extern "C" {

int collided_ask_rays(collided_client* client, size_t count, const double* origins, const double* directions,
                      const double* lengths_m, const collided_ask_options* options, collided_answers** answers,
                      collided_error* error) {
  const auto make = [&](std::size_t i) {
    return RayQuestion{.origin = vector(origins + 3 * i),
                       .direction = vector(directions + 3 * i),
                       .length_m = lengths_m ? lengths_m[i] : kUnlimited};
  };
  return ask_rows(client, count, origins && directions, make, options, answers, error);
}

int collided_ask_spheres(collided_client* client, size_t count, const double* centers, const double* radii_m,
                         const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  const auto make = [&](std::size_t i) {
    return SphereQuestion{.center = vector(centers + 3 * i), .radius_m = radii_m[i]};
  };
  return ask_rows(client, count, centers && radii_m, make, options, answers, error);
}

int collided_ask_boxes(collided_client* client, size_t count, const double* centers, const double* half_m,
                       const double* orientations, const collided_ask_options* options, collided_answers** answers,
                       collided_error* error) {
  const auto make = [&](std::size_t i) {
    return BoxQuestion{.center = vector(centers + 3 * i),
                       .half_m = vector(half_m + 3 * i),
                       .rotation = rotation(orientations ? orientations + 4 * i : nullptr)};
  };
  return ask_rows(client, count, centers && half_m, make, options, answers, error);
}

int collided_ask_nearest(collided_client* client, size_t count, const double* points, const double* within_m,
                         const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  const auto make = [&](std::size_t i) {
    return NearQuestion{.point = vector(points + 3 * i), .within_m = within_m ? within_m[i] : kUnlimited};
  };
  return ask_rows(client, count, points != nullptr, make, options, answers, error);
}

int collided_ask_inside(collided_client* client, size_t count, const double* points,
                        const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  const auto make = [&](std::size_t i) { return InsideQuestion{.point = vector(points + 3 * i)}; };
  return ask_rows(client, count, points != nullptr, make, options, answers, error);
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
