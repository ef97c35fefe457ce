#include "server/world/audit/fcl_opinion.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "server/geometry/float_environment.hpp"
#include "server/intake/child_process.hpp"
#include "server/intake/helper_program.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/query/object_parts.hpp"
#include "server/world/query/question_shapes.hpp"

namespace collided::engine {
namespace {

/// How far FCL's distance may be from ours and still agree, beyond our own bound; relative to the size of the two. It
/// absorbs the step at which FCL's search for the nearest points stops, 1e-6 by its default.
/// At zero, FclOpinion.EveryShapeAgrees fails.
constexpr double kOpinionDistance = 1e-6;

Opinion unsupported(std::string why) { return {.verdict = OpinionVerdict::unsupported, .why = std::move(why)}; }
Opinion failed(std::string why) { return {.verdict = OpinionVerdict::failed, .why = std::move(why)}; }

std::string first_line(std::string_view text) {
  constexpr std::size_t kMost = 300;
  std::string line(text.substr(0, std::min(text.find('\n'), kMost)));
  for (char& c : line) c = c < ' ' && c >= 0 ? '?' : c;
  return line;
}

/// "touching", "apart 0.25", "apart - WHY" or "unsupported WHY".
Opinion opinion_in(std::string_view line) {
  const auto take = [&line](std::string_view head) {
    const bool is_there = line.starts_with(head);
    if (is_there) line.remove_prefix(head.size());
    return is_there;
  };
  if (line == "touching") return {.verdict = OpinionVerdict::unsupported, .touches = true};
  if (take("unsupported ")) return unsupported(std::string(line));
  if (take("apart - ")) return {.verdict = OpinionVerdict::unsupported, .touches = false, .why = std::string(line)};
  double distance_m = 0;
  if (take("apart ") && std::from_chars(line.data(), line.data() + line.size(), distance_m).ec == std::errc{} &&
      std::isfinite(distance_m)) {
    return {.verdict = OpinionVerdict::unsupported, .touches = false, .distance_m = distance_m};
  }
  return failed("collided-opinion printed no answer");
}

double size_of(const OpinionRequest& request) {
  Aabb all;
  for (const auto* parts : {&request.a, &request.b}) {
    for (const ConvexPart& part : *parts) {
      if (half_space_of(part) == nullptr) all.extend(bounds_of_part(part));
    }
  }
  return all.empty() ? 0 : (all.high - all.low).norm();
}

}  // namespace

void count(OpinionVerdict verdict, OpinionCounts& counts) {
  switch (verdict) {
    case OpinionVerdict::agree: ++counts.agree; break;
    case OpinionVerdict::differ: ++counts.differ; break;
    case OpinionVerdict::failed: ++counts.failed; break;
    case OpinionVerdict::unsupported: ++counts.unsupported; break;
  }
}

Opinion ask_opinion_program(const OpinionRequest& request, const std::function<bool()>& cancelled) {
  const HelperProgram program = find_helper_program("collided-opinion", "COLLIDED_OPINION_PROGRAM");
  if (program.path.empty()) return failed(program.why_not);
  const std::vector<std::byte> bytes = encoded(request);
  if (bytes.size() > kMostOpinionBytes)
    return unsupported(fmt::format("{} bytes of shapes; at most {} are sent to FCL", bytes.size(), kMostOpinionBytes));
  const ChildResult result = run_child({program.path}, std::chrono::seconds(kOpinionSeconds), cancelled, bytes);
  if (!result.start_failure.empty())
    return failed(fmt::format("{} cannot be started: {}", program.path, result.start_failure));
  if (result.cancelled) return failed("called off");
  if (result.timed_out) return failed(fmt::format("FCL needed more than {} s and was ended", kOpinionSeconds));
  const std::string said = first_line(result.errors);
  if (result.signal != 0)
    return failed(fmt::format("FCL was ended by signal {}{}{}", result.signal, said.empty() ? "" : ": ", said));
  if (result.exit_code != 0)
    return failed(
        fmt::format("collided-opinion failed with code {}{}{}", result.exit_code, said.empty() ? "" : ": ", said));
  return opinion_in(first_line(result.output));
}

Opinion compared(Opinion said, const PairReport& ours, double size_m) {
  if (!said.touches) return said;
  if (ours.touches == Decision::undecided) {
    said.verdict = OpinionVerdict::unsupported;
    said.why = "our own answer is undecided: nothing to compare";
    return said;
  }
  const bool same = *said.touches == (ours.touches == Decision::yes);
  said.verdict = same ? OpinionVerdict::agree : OpinionVerdict::differ;
  if (!same || !said.distance_m) return said;
  const double off_m = std::abs(*said.distance_m - ours.separation.distance_m);
  if (!(off_m <= ours.separation.error_m + kOpinionDistance * size_m)) said.verdict = OpinionVerdict::differ;
  return said;
}

Opinion fcl_opinion(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairReport& ours,
                    const std::function<bool()>& cancelled) {
  const OwnFloatEnvironment own_floats;
  const std::size_t part_count = part_count_of(snapshot, a) + part_count_of(snapshot, b);
  if (part_count > kMostOpinionParts)
    return unsupported(fmt::format("{} parts; at most {} are sent to FCL", part_count, kMostOpinionParts));
  const OpinionRequest request{parts_of_object(snapshot, a), parts_of_object(snapshot, b)};
  return compared(ask_opinion_program(request, cancelled), ours, size_of(request));
}

namespace {

/// All parts that may answer and whose bounds meet those of the question's shape.
std::vector<ConvexPart> parts_near(const Snapshot& snapshot, const Questions& question, const Aabb& box) {
  std::vector<ConvexPart> parts;
  visit_parts(snapshot, [&](ObjectId object, std::uint32_t, const auto& shape, const GivenPart&) {
    if (!overlaps(box, bounds(shape)) || !may_answer(*snapshot.objects[slot_of(object)], question)) return;
    if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Triangle>) parts.emplace_back(shape);
    else parts.emplace_back(Primitive(shape));
  });
  return parts;
}

}  // namespace

Opinion fcl_opinion(const Snapshot& snapshot, const Questions& question, const Answers& given,
                    const std::function<bool()>& cancelled) {
  const OwnFloatEnvironment own_floats;
  const bool is_sphere = question.kind == QuestionKind::sphere;
  if (!is_sphere && question.kind != QuestionKind::box) return unsupported("FCL is asked about spheres and boxes only");
  const Verdict verdict = given.answers[0];
  if (verdict != Verdict::hit && verdict != Verdict::miss)
    return unsupported("our own answer is undecided: nothing to compare");
  const double* numbers = question.numbers.data();
  const Primitive asked = is_sphere ? Primitive(sphere_of(numbers)) : Primitive(box_of(numbers));
  OpinionRequest request{{asked}, parts_near(snapshot, question, bounds(asked))};
  if (request.b.empty()) return unsupported("nothing lies near enough to be touched");
  if (request.b.size() >= kMostOpinionParts)
    return unsupported(
        fmt::format("{} parts are near; at most {} are sent to FCL", request.b.size(), kMostOpinionParts));
  Opinion said = ask_opinion_program(request, cancelled);
  if (said.touches)
    said.verdict = *said.touches == (verdict == Verdict::hit) ? OpinionVerdict::agree : OpinionVerdict::differ;
  return said;
}

}  // namespace collided::engine
