#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

/// Rows and the whole point to the texts of `told`, so it stays where it is.
struct collided_explanation {
  std::variant<ExplainedRay, ExplainedPair, ExplainedFence, ExplainedNearest, ExplainedEvent> told;
  collided_explained whole{};
  std::vector<collided_explained_row> rows;
};

namespace {

constexpr const char* kNoText = "";

collided_explained_row row_of(std::int32_t role, const char* object) {
  collided_explained_row row{};
  row.role = role;
  row.object = object;
  row.what = row.why = row.doubt = kNoText;
  row.triangle = row.part = kNoTriangle;
  return row;
}

template <class Value>
std::int64_t ns_or_0(const std::optional<Value>& time) {
  return time ? time->count() : 0;
}

collided_explained_row row_of(std::int32_t role, const ExplainedMeeting& met) {
  collided_explained_row row = row_of(role, met.object.c_str());
  row.verdict = COLLIDED_HIT;
  row.rung = static_cast<std::int32_t>(met.rung);
  row.what = met.kind.c_str();
  row.why = met.why_left_out.c_str();
  row.distance_m = met.distance_m;
  row.error_m = met.error_m;
  put(met.point, row.point);
  row.triangle = met.triangle;
  row.part = met.part.value_or(kNoTriangle);
  row.inside = met.inside ? 1 : 0;
  row.stale = met.stale ? 1 : 0;
  row.age_ns = ns_or_0(met.age);
  return row;
}

collided_explained_row row_of(const ExplainedMiss& miss) {
  collided_explained_row row = row_of(COLLIDED_PASSED, miss.object.c_str());
  row.verdict = static_cast<std::int32_t>(miss.verdict);
  row.why = miss.why_left_out.c_str();
  row.distance_m = miss.distance_m;
  row.error_m = miss.error_m;
  row.along_m = miss.along_m;
  put(miss.on_ray, row.point);
  put(miss.on_object, row.on_object);
  row.triangle = miss.triangle;
  row.where = static_cast<std::int32_t>(miss.where);
  row.box_met = miss.box_met ? 1 : 0;
  return row;
}

collided_explained_row row_of(std::int32_t role, const ExplainedStanding& standing) {
  collided_explained_row row = row_of(role, standing.object.c_str());
  row.verdict = static_cast<std::int32_t>(standing.verdict);
  row.why = standing.why_left_out.c_str();
  row.doubt = standing.doubt.c_str();
  row.distance_m = standing.clearance_m;
  row.error_m = standing.error_m;
  row.stale = standing.stale ? 1 : 0;
  row.told = standing.told ? 1 : 0;
  row.sequence = standing.episode;
  row.from_ns = ns_or_0(standing.since);
  return row;
}

collided_explained_row row_of(const ExplainedBody& body) {
  collided_explained_row row = row_of(COLLIDED_BODY, body.object.c_str());
  row.known = body.remembered ? 1 : 0;
  row.what = body.publisher.c_str();
  put(body.pose.position, row.point);
  row.from_ns = ns_or_0(body.motion_from);
  row.to_ns = ns_or_0(body.motion_to);
  return row;
}

collided_explained_row row_of(std::int32_t role, const ExplainedGap& gap) {
  collided_explained_row row = row_of(role, kNoText);
  row.verdict = static_cast<std::int32_t>(gap.verdict);
  row.distance_m = gap.clearance_m;
  row.error_m = gap.error_m;
  row.from_ns = row.to_ns = gap.time.count();
  return row;
}

collided_explained_row sentence_row(const std::string& sentence) {
  collided_explained_row row = row_of(COLLIDED_REASON, kNoText);
  row.why = sentence.c_str();
  return row;
}

void lend(const ExplainedRay& ray, collided_explanation& to) {
  to.whole.verdict = static_cast<std::int32_t>(ray.verdict);
  to.whole.reason = static_cast<std::int32_t>(ray.reason);
  to.whole.rung = static_cast<std::int32_t>(ray.rung);
  to.whole.late = ray.late ? 1 : 0;
  to.whole.cut = ray.cut ? 1 : 0;
  to.whole.has_uncovered = ray.uncovered ? 1 : 0;
  if (ray.uncovered) to.whole.covered_m = ray.uncovered->covered_m;
  to.whole.nodes = ray.nodes;
  to.whole.exact_tests = ray.exact_tests;
  to.whole.objects = ray.objects;
  to.whole.candidates = ray.boxes_met;
  to.whole.left_out = ray.left_out_count;
  to.whole.version = ray.version;
  to.whole.world_time_ns = ray.world_time.count();
  for (const ExplainedMeeting& met : ray.met) to.rows.push_back(row_of(COLLIDED_MET, met));
  for (const ExplainedMeeting& met : ray.left_out) to.rows.push_back(row_of(COLLIDED_LEFT_OUT, met));
  for (const ExplainedMiss& miss : ray.misses) to.rows.push_back(row_of(miss));
  for (const ExplainedStale& stale : ray.stale) {
    collided_explained_row& row = to.rows.emplace_back(row_of(COLLIDED_STALE, stale.object.c_str()));
    row.age_ns = stale.age.count();
    row.along_m = stale.from_m;
  }
  for (const std::string& name : ray.unknown) to.rows.push_back(row_of(COLLIDED_UNKNOWN, name.c_str()));
}

void lend(const ExplainedPair& pair, collided_explanation& to) {
  const PairAnswer& answer = pair.answer;
  to.whole.verdict = static_cast<std::int32_t>(answer.verdict);
  to.whole.reason = static_cast<std::int32_t>(answer.reason);
  to.whole.stale = answer.stale ? 1 : 0;
  to.whole.clearance_m = answer.verdict == Verdict::hit ? -answer.depth_m : answer.distance_m;
  to.whole.error_m = answer.error_m;
  to.whole.version = answer.version;
  to.whole.why = pair.no_nearest.c_str();
  if (const auto& nearest = pair.nearest) {
    to.whole.has_nearest = 1;
    to.whole.end = static_cast<std::int32_t>(nearest->end);
    to.whole.from_ns = nearest->from.count();
    to.whole.to_ns = nearest->to.count();
    to.whole.nearest_ns = nearest->time.count();
    to.whole.nearest_m = nearest->distance_m;
    to.whole.nearest_error_m = nearest->error_m;
    to.whole.at_least_m = nearest->at_least_m;
  }
  for (const std::string& sentence : pair.why_not) to.rows.push_back(sentence_row(sentence));
}

collided_explained_row row_of(const ExplainedNews& news) {
  collided_explained_row row = row_of(COLLIDED_NEWS, news.object.c_str());
  row.what = news.what.c_str();
  row.why = news.why.c_str();
  row.doubt = news.doubt.c_str();
  row.sequence = news.sequence;
  row.from_ns = news.low.count();
  row.to_ns = news.high.count();
  return row;
}

void lend(const ExplainedNearest& nearest, collided_explanation& to) {
  to.whole.late = nearest.late ? 1 : 0;
  to.whole.objects = nearest.looked_at;
  to.whole.a = nearest.nearest.c_str();
  to.whole.b = nearest.to.c_str();
  to.whole.cut_short = nearest.cut_short;
  to.whole.version = nearest.version;
  to.whole.world_time_ns = nearest.world_time.count();
  if (nearest.is) to.rows.push_back(row_of(COLLIDED_INSIDE, *nearest.is));
  for (const ExplainedStanding& one : nearest.others) to.rows.push_back(row_of(COLLIDED_OUTSIDE, one));
  for (const ExplainedStanding& one : nearest.left_out) to.rows.push_back(row_of(COLLIDED_LEFT_OUT, one));
  if (nearest.asked_for) to.rows.push_back(row_of(COLLIDED_ASKED_FOR, *nearest.asked_for));
  for (const ExplainedNews& news : nearest.events) to.rows.push_back(row_of(news));
}

void lend(const ExplainedFence& fence, collided_explanation& to) {
  to.whole.late = fence.late ? 1 : 0;
  to.whole.objects = fence.looked_at;
  to.whole.a = fence.fence.c_str();
  to.whole.b = fence.to.c_str();
  to.whole.version = fence.version;
  to.whole.world_time_ns = fence.world_time.count();
  for (const ExplainedStanding& one : fence.inside) to.rows.push_back(row_of(COLLIDED_INSIDE, one));
  for (const ExplainedStanding& one : fence.outside) to.rows.push_back(row_of(COLLIDED_OUTSIDE, one));
  for (const ExplainedStanding& one : fence.left_out) to.rows.push_back(row_of(COLLIDED_LEFT_OUT, one));
  if (fence.asked_for) to.rows.push_back(row_of(COLLIDED_ASKED_FOR, *fence.asked_for));
  for (const ExplainedNews& news : fence.events) to.rows.push_back(row_of(news));
}

void lend(const ExplainedEvent& event, collided_explanation& to) {
  to.whole.what = event.what.c_str();
  to.whole.why = event.why.c_str();
  to.whole.doubt = event.doubt.c_str();
  to.whole.a = event.a.c_str();
  to.whole.b = event.b.c_str();
  to.whole.sequence = event.sequence;
  to.whole.low_ns = event.low.count();
  to.whole.high_ns = event.high.count();
  to.whole.version = event.version;
  to.whole.world_time_ns = event.world_time.count();
  for (const ExplainedBody& body : event.bodies) to.rows.push_back(row_of(body));
  if (event.before) to.rows.push_back(row_of(COLLIDED_BEFORE, *event.before));
  if (event.after) to.rows.push_back(row_of(COLLIDED_AFTER, *event.after));
  for (const std::string& sentence : event.why_wide) to.rows.push_back(sentence_row(sentence));
}

ExplainOptions explain_options(const collided_explain_options* options) {
  ExplainOptions made;
  if (!options) return made;
  const collided_explain_options given = taken(options);
  made.mask = ~given.left_out_layers;
  made.only = text(given.only);
  made.skip = text(given.skip);
  made.why_not = text(given.why_not);
  if (given.most != 0) made.most = given.most;
  made.as_of = {.kind = static_cast<Instant::Kind>(given.instant), .time = std::chrono::nanoseconds(given.instant_ns)};
  made.last = std::chrono::nanoseconds(given.last_ns);
  made.deadline = std::chrono::nanoseconds(given.deadline_ns);
  if (given.timeout_ns != 0) made.timeout = std::chrono::nanoseconds(given.timeout_ns);
  return made;
}

/// ask  the client's call
template <class Ask>
int explain(collided_client* client, const collided_explain_options* options, collided_explanation** explanation,
            collided_error* error, const Ask& ask) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (!explanation) return missing("explanation");
    *explanation = nullptr;
    auto told = ask(client->client, explain_options(options));
    if (!told) return told.error();
    auto made = std::make_unique<collided_explanation>();
    made->told = std::move(*told);
    for (const char** name : {&made->whole.what, &made->whole.why, &made->whole.doubt, &made->whole.a, &made->whole.b})
      *name = kNoText;
    std::visit([&](const auto& kind) { lend(kind, *made); }, made->told);
    *explanation = made.release();
    return {};
  });
}

}  // namespace

extern "C" {

int collided_explain_ray(collided_client* client, const double* origin, const double* direction, double length_m,
                         const collided_explain_options* options, collided_explanation** explanation,
                         collided_error* error) {
  return explain(client, options, explanation, error, [&](Client& asked, const ExplainOptions& how) {
    if (!origin || !direction) return Result<ExplainedRay>(missing("an array of numbers"));
    return asked.explain_ray({.origin = vector(origin), .direction = vector(direction), .length_m = length_m}, how);
  });
}

int collided_explain_pair(collided_client* client, const char* a, const char* b,
                          const collided_explain_options* options, collided_explanation** explanation,
                          collided_error* error) {
  return explain(client, options, explanation, error,
                 [&](Client& asked, const ExplainOptions& how) { return asked.explain_pair(text(a), text(b), how); });
}

int collided_explain_fence(collided_client* client, const char* name, const collided_explain_options* options,
                           collided_explanation** explanation, collided_error* error) {
  return explain(client, options, explanation, error,
                 [&](Client& asked, const ExplainOptions& how) { return asked.explain_fence(text(name), how); });
}

int collided_explain_nearest(collided_client* client, const char* name, const collided_explain_options* options,
                             collided_explanation** explanation, collided_error* error) {
  return explain(client, options, explanation, error,
                 [&](Client& asked, const ExplainOptions& how) { return asked.explain_nearest(text(name), how); });
}

int collided_explain_event(collided_client* client, uint64_t sequence, int32_t of_fences,
                           const collided_explain_options* options, collided_explanation** explanation,
                           collided_error* error) {
  return explain(client, options, explanation, error, [&](Client& asked, const ExplainOptions& how) {
    return asked.explain_event(sequence, of_fences != 0 ? EventsOf::fences : EventsOf::contacts, how);
  });
}

void collided_free_explanation(collided_explanation* explanation) { delete explanation; }

void collided_read_explained(const collided_explanation* explanation, collided_explained* explained) {
  if (explanation) give(explanation->whole, explained);
}

size_t collided_explained_count(const collided_explanation* explanation) {
  return explanation ? explanation->rows.size() : 0;
}

int collided_read_explained_row(const collided_explanation* explanation, size_t number, collided_explained_row* row) {
  if (number >= collided_explained_count(explanation)) return COLLIDED_NOTHING;
  give(explanation->rows[number], row);
  return COLLIDED_OK;
}

}  // extern "C"
