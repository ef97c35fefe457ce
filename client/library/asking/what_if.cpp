#include "client/library/asking/what_if.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/asking/question_request.hpp"
#include "client/library/connection/errors.hpp"

namespace collided::client {
namespace {

std::optional<Error> what_if_fault(const WhatIfConfigurations& given, const WhatIfOptions& options) {
  const std::size_t moved = given.objects.size();
  if (moved == 0 || moved > wire_contract::kMaxPosesPerChunk)
    return bad_input("what-if: " + std::to_string(moved) + " objects; allowed 1 to " +
                     std::to_string(wire_contract::kMaxPosesPerChunk));
  for (const std::string& name : given.objects) {
    if (name.empty() || name.size() > wire_contract::kMaxNameBytes || name.find('\0') != std::string::npos)
      return bad_input("what-if: a name of " + std::to_string(name.size()) +
                       " bytes, or with a zero in it; allowed 1 to " + std::to_string(wire_contract::kMaxNameBytes));
  }
  const std::size_t count = given.poses.size() / moved;
  if (given.poses.size() % moved != 0 || count == 0 || count > wire_contract::kMaxQuestionsPerRequest)
    return bad_input("what-if: " + std::to_string(given.poses.size()) + " poses for " + std::to_string(moved) +
                     " objects; a request holds 1 to " + std::to_string(wire_contract::kMaxQuestionsPerRequest) +
                     " configurations, each with a pose for every object");
  for (std::size_t i = 0; i < given.poses.size(); ++i) {
    double row[wire_contract::kPoseNumbers];
    double* numbers = row;
    put(numbers, given.poses[i]);
    for (const wire_contract::NumberField& field : wire_contract::kPoseFields) {
      if (auto found = fault(field, row))
        return bad_input("what-if: configuration " + std::to_string(i / moved) + ", object '" +
                         given.objects[i % moved] + "': " + *found);
    }
  }
  if (!(options.nearer_m >= 0))
    return bad_input("what-if: nearer_m is " + words(options.nearer_m) + "; allowed 0 or more");
  return std::nullopt;
}

/// Converts the answers of a what-if: the two hits of each are a pair.
WhatIfAnswers pairs_of(Answers&& answers) {
  WhatIfAnswers told;
  told.version = answers.version;
  told.world_time = answers.world_time;
  told.compute = answers.compute;
  told.configurations.reserve(answers.answers.size());
  for (Answer& answer : answers.answers) {
    ConfigurationAnswer& one = told.configurations.emplace_back();
    one.verdict = answer.verdict;
    one.reason = answer.reason;
    if (answer.hits.size() != 2) continue;
    Hit& a = answer.hits[0];
    Hit& b = answer.hits[1];
    ClearancePair& pair = one.nearest.emplace();
    pair.a = std::move(a.object);
    pair.b = std::move(b.object);
    pair.a_id = a.object_id;
    pair.b_id = b.object_id;
    pair.verdict = answer.verdict;
    pair.stale = a.stale;
    pair.clearance_m = a.distance_m;
    pair.error_m = a.error_m;
    pair.contained = a.inside ? Containment::a_in_b : b.inside ? Containment::b_in_a : Containment::none;
    pair.on_a = a.point;
    pair.on_b = b.point;
    pair.point_error_m = a.point_error_m;
    pair.normal = a.normal;
    pair.a_triangle = a.triangle;
    pair.b_triangle = b.triangle;
  }
  return told;
}

}  // namespace

Result<WhatIfAnswers> what_if(Connection& connection, const WhatIfConfigurations& given, const WhatIfOptions& options) {
  if (auto error = what_if_fault(given, options)) return *error;
  const std::size_t moved = given.objects.size();
  nlohmann::json text = nlohmann::json::object();
  if (std::isfinite(options.nearer_m)) text["nearer_m"] = options.nearer_m;
  if (options.with_filtered) text["with_filtered"] = true;
  for (const auto& [child, parent] : options.attached) text["attached"].push_back({child, parent});
  const std::vector<std::uint8_t> names = wire_contract::pack_names(given.objects);
  QuestionRequest request{.kind = wire_contract::QuestionKind::what_if,
                          .noun = "what-if",
                          .number_count = static_cast<std::uint32_t>(moved) * wire_contract::kPoseNumbers,
                          .question_count = given.poses.size() / moved,
                          .encode =
                              [&](std::size_t first, std::size_t count, double* numbers) {
                                for (const Pose& pose : std::span(given.poses).subspan(first * moved, count * moved))
                                  put(numbers, pose);
                              },
                          .blob = names,
                          .text = text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                          .most_in_chunk = wire_contract::kMaxPosesPerChunk / moved};
  if (request.text.size() >= sizeof(wire::Query::text))
    return bad_input("what-if: the names of what is attached take " + std::to_string(request.text.size()) +
                     " bytes; allowed " + std::to_string(sizeof(wire::Query::text) - 1));
  AskOptions asked;
  asked.mode = options.with_clearance ? HitMode::closest : HitMode::any;
  asked.only = options.against;
  asked.skip = options.skip;
  asked.mask = options.mask;
  asked.as_of = options.as_of;
  asked.importance = options.importance;
  asked.fresh = options.fresh;
  asked.deadline = options.deadline;
  asked.timeout = options.timeout;
  Result<Answers> answers = run(connection, request, asked, {});
  if (!answers) return answers.error();
  return pairs_of(std::move(*answers));
}

}  // namespace collided::client
