#include <limits>
#include <utility>

#include "client/library/c/answers.hpp"
#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

namespace {

/// The two hits by which collided.h tells a pair.
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

std::vector<std::string> texts(const char* const* given, std::size_t count) {
  std::vector<std::string> made;
  for (std::size_t i = 0; i < count; ++i) made.push_back(text(given[i]));
  return made;
}

Result<Answers> clearance_answers(const Result<ClearanceAnswer>& said) {
  if (!said) return said.error();
  Answers made;
  made.version = said->version;
  Answer& answer = made.answers.emplace_back();
  answer.verdict = said->verdict;
  answer.reason = said->cut && said->verdict != Verdict::undecided ? UndecidedReason::truncated : said->reason;
  for (const ClearancePair& pair : said->pairs) put_pair(pair, answer);
  if (said->uncovered)
    answer.uncovered = Uncovered{.point = *said->uncovered, .covered_m = std::numeric_limits<double>::quiet_NaN()};
  return made;
}

Result<Answers> what_if_answers(const Result<WhatIfAnswers>& said) {
  if (!said) return said.error();
  Answers made;
  made.version = said->version;
  made.world_time = said->world_time;
  made.compute = said->compute;
  for (const ConfigurationAnswer& one : said->configurations) {
    Answer& answer = made.answers.emplace_back();
    answer.verdict = one.verdict;
    answer.reason = one.reason;
    if (one.nearest) put_pair(*one.nearest, answer);
  }
  return made;
}

}  // namespace

extern "C" {

int collided_clearance(collided_client* client, const char* from, const char* to, uint32_t most, double nearer_m,
                       const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!answers) return missing("answers");
    const AskOptions asked = ask_options(options);
    ClearanceOptions made{.to = text(to), .skip = asked.skip, .most = most, .nearer_m = nearer_m};
    made.as_of = asked.as_of;
    made.deadline = asked.deadline;
    if (options && options->timeout_ns != 0) made.timeout = asked.timeout;
    return hand_over(clearance_answers(client->client.clearance(text(from), made)), answers);
  });
}

int collided_what_if(collided_client* client, const char* const* objects, size_t object_count, size_t count,
                     const double* poses, const char* const* attached, size_t attached_count, double nearer_m,
                     const collided_ask_options* options, collided_answers** answers, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!answers) return missing("answers");
    if ((object_count > 0 && !objects) || (attached_count > 0 && !attached)) return missing("a list of names");
    if (count * object_count > 0 && !poses) return missing("an array of numbers");
    const AskOptions asked = ask_options(options);
    WhatIfConfigurations made{.objects = texts(objects, object_count), .poses = {}};
    for (std::size_t i = 0; i < count * object_count; ++i)
      made.poses.push_back({.position = vector(poses + 7 * i), .rotation = rotation(poses + 7 * i + 3)});
    WhatIfOptions how{.against = asked.only, .skip = asked.skip, .mask = asked.mask};
    how.with_clearance = asked.mode != HitMode::any;
    how.nearer_m = nearer_m;
    for (std::size_t i = 0; i < attached_count; ++i)
      how.attached.emplace_back(text(attached[2 * i]), text(attached[2 * i + 1]));
    how.as_of = asked.as_of;
    how.importance = asked.importance;
    how.fresh = asked.fresh;
    how.deadline = asked.deadline;
    if (options && options->timeout_ns != 0) how.timeout = asked.timeout;
    return hand_over(what_if_answers(client->client.what_if(made, how)), answers);
  });
}

}  // extern "C"
