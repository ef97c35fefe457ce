#include "client/library/asking/answer_decoding.hpp"

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "client/library/asking/vector_column.hpp"
#include "idl/columns.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

Error nonsense(const std::string& what) {
  return {ErrorCode::internal, "the server's reply makes no sense: " + what,
          "client and server may be of different versions: 'collide version'"};
}

// Caches the last name, since successive hits are mostly on one object.
struct LastName {
  std::uint64_t id = 0;
  std::string name = {};
  const std::string& of(std::uint64_t object, const Names& names) {
    if (object != id || name.empty()) {
      name = names.name(object);
      id = object;
    }
    return name;
  }
};

/// A hit has either the columns of sweeps or those of other questions; the others are empty, and 0 in the hit.
double number_in(const dds_sequence_double& column, std::size_t index) {
  return column._length > 0 ? dds::view(column)[index] : 0;
}

void decode_hit(const wire::Reply& reply, std::size_t index, const Names& names, LastName& last, Hit& hit) {
  const std::uint8_t flags = dds::view(reply.hit_flags)[index];
  hit.object_id = dds::view(reply.objects)[index];
  hit.object = last.of(hit.object_id, names);
  hit.triangle = dds::view(reply.triangles)[index];
  hit.distance_m = number_in(reply.distances, index);
  hit.error_m = number_in(reply.distance_errors, index);
  hit.exit_m = number_in(reply.exits, index);
  hit.time_low = number_in(reply.sweep_begins, index);
  hit.time_high = number_in(reply.sweep_ends, index);
  hit.point = vector_in(reply.points, index);
  hit.normal = vector_in(reply.normals, index);
  hit.weights = vector_in(reply.weights, index);
  hit.point_error_m = dds::view(reply.point_errors)[index];
  hit.inside = (flags & wire_contract::kHitInside) != 0;
  hit.by_winding = (flags & wire_contract::kHitByWinding) != 0;
  hit.stale = (flags & wire_contract::kHitStale) != 0;
}

std::optional<Uncovered> uncovered_of(const wire::Reply& reply, std::uint32_t question) {
  const auto questions = dds::view(reply.uncovered_questions);
  const auto found = std::lower_bound(questions.begin(), questions.end(), question);
  if (found == questions.end() || *found != question) return std::nullopt;
  const auto row = static_cast<std::size_t>(found - questions.begin());
  return Uncovered{.point = vector_in(reply.uncovered_points, row),
                   .covered_m = dds::view(reply.uncovered_distances)[row]};
}

}  // namespace

std::string text_of(const wire::Reply& reply) {
  const auto bytes = dds::view(reply.text);
  return {bytes.begin(), bytes.end()};
}

Error refusal(const std::string& text) {
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  const auto field = [&](const char* name, const std::string& otherwise) {
    return parsed.is_object() && parsed.contains(name) && parsed[name].is_string() ? parsed[name].get<std::string>()
                                                                                   : otherwise;
  };
  Error error{ErrorCode::refused, "server refused: " + field("error", text), field("hint", "")};
  if (parsed.is_object() && parsed.contains("retry_after_ms") && parsed["retry_after_ms"].is_number_unsigned()) {
    constexpr std::uint64_t kMost = 60'000;  // a server never asks for more
    error.retry_after = std::chrono::milliseconds(std::min(parsed["retry_after_ms"].get<std::uint64_t>(), kMost));
  }
  return error;
}

AnswerCollector::AnswerCollector(std::size_t question_count, std::size_t questions_per_chunk, Names& names,
                                 Answers&& earlier)
    : names_(names),
      questions_per_chunk_(questions_per_chunk),
      seen_(question_count, 0),
      open_in_chunk_((question_count + questions_per_chunk - 1) / questions_per_chunk) {
  result_.answers = std::move(earlier.answers);
  result_.answers.resize(question_count);
  for (std::size_t chunk = 0; chunk < open_in_chunk_.size(); ++chunk) {
    const std::size_t left = question_count - chunk * questions_per_chunk;
    open_in_chunk_[chunk] = static_cast<std::uint32_t>(std::min(left, questions_per_chunk));
  }
}

std::optional<Error> AnswerCollector::check(const wire::Reply& reply) const {
  const std::size_t count = reply.answers._length;
  const std::size_t hits = reply.objects._length;
  if (reply.first_question > seen_.size() || count > seen_.size() - reply.first_question) {
    return nonsense("answers " + std::to_string(reply.first_question) + " and on to " + std::to_string(seen_.size()) +
                    " questions");
  }
  if (reply.reasons._length != count || reply.levels._length != count || reply.hit_counts._length != count ||
      reply.nodes._length != count || reply.exact_tests._length != count) {
    return nonsense("its lists of answers differ in length");
  }
  const auto hit_counts = dds::view(reply.hit_counts);
  if (std::accumulate(hit_counts.begin(), hit_counts.end(), std::size_t{0}) != hits ||
      reply.triangles._length != hits || reply.hit_flags._length != hits ||
      wire::row_count(reply, wire::hit_columns(reply)) != hits) {
    return nonsense("its lists of hits differ in length");
  }
  const std::uint32_t uncovered = reply.uncovered_questions._length;
  const auto uncovered_questions = dds::view(reply.uncovered_questions);
  if (wire::row_count<wire::Reply>(reply, wire::kUncoveredColumns) != uncovered ||
      !std::is_sorted(uncovered_questions.begin(), uncovered_questions.end())) {
    return nonsense("its lists of what is not covered differ in length, or are out of order");
  }
  const auto answers = dds::view(reply.answers);
  const auto reasons = dds::view(reply.reasons);
  if (!std::ranges::all_of(answers, codes::is_known<Verdict>) ||
      !std::ranges::all_of(reasons, codes::is_known<UndecidedReason>)) {
    return nonsense("an answer of an unknown kind");
  }
  if (answered_ > 0 && (reply.epoch != result_.epoch || reply.version != result_.version)) {
    return nonsense("one request answered on versions " + std::to_string(result_.version) + " and " +
                    std::to_string(reply.version));
  }
  return std::nullopt;
}

void AnswerCollector::note_state(const wire::Reply& reply) {
  result_.epoch = reply.epoch;
  result_.server = reply.server;
  result_.version = reply.version;
  result_.world_time = nanoseconds(reply.world_time_ns);
  result_.compute += nanoseconds(reply.compute_ns);
  if (reply.oldest_pose_age_ns >= 0) {
    const nanoseconds age(reply.oldest_pose_age_ns);
    result_.oldest_pose_age = std::max(age, result_.oldest_pose_age.value_or(age));
  }
}

void AnswerCollector::note_answered(std::size_t first, std::size_t count) {
  for (std::size_t question = first; question < first + count;) {
    const std::size_t chunk = question / questions_per_chunk_;
    const std::size_t end = std::min(first + count, (chunk + 1) * questions_per_chunk_);
    std::uint32_t answered = 0;
    for (; question < end; ++question) {
      answered += seen_[question] == 0 ? 1U : 0U;
      seen_[question] = 1;
    }
    answered_ += answered;
    open_in_chunk_[chunk] -= answered;
    chunks_answered_ += answered > 0 && open_in_chunk_[chunk] == 0 ? 1 : 0;
  }
}

std::optional<Error> AnswerCollector::add(const wire::Reply& reply) {
  if (reply.status == static_cast<std::uint8_t>(wire_contract::ReplyStatus::refused)) {
    return refusal(text_of(reply));
  }
  if (auto error = check(reply)) { return error; }
  names_.learn(dds::view(reply.named_ids), dds::view(reply.names));
  const auto verdicts = dds::view(reply.answers);
  const auto reasons = dds::view(reply.reasons);
  const auto hit_counts = dds::view(reply.hit_counts);
  const auto nodes = dds::view(reply.nodes);
  const auto exact_tests = dds::view(reply.exact_tests);
  const auto levels = dds::view(reply.levels);
  LastName last_name;
  std::size_t next_hit = 0;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const std::size_t question = reply.first_question + i;
    if (seen_[question] == 0) {
      Answer& answer = result_.answers[question];
      answer.verdict = static_cast<Verdict>(verdicts[i]);
      answer.reason = static_cast<UndecidedReason>(reasons[i]);
      answer.cost = {nodes[i], exact_tests[i], levels[i]};
      answer.hits.resize(hit_counts[i]);
      for (std::size_t hit = 0; hit < answer.hits.size(); ++hit) {
        decode_hit(reply, next_hit + hit, names_, last_name, answer.hits[hit]);
      }
      answer.uncovered = uncovered_of(reply, static_cast<std::uint32_t>(i));
    }
    next_hit += hit_counts[i];
  }
  const std::size_t answered_before = answered_;
  note_answered(reply.first_question, verdicts.size());
  // A repeated reply must not count twice in the costs and ages.
  if (answered_ > answered_before) note_state(reply);
  return std::nullopt;
}

}  // namespace collided::client
