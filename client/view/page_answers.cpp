#include "client/view/page_answers.hpp"

#include <map>

#include "client/view/json_text.hpp"
#include "client/view/page_messages.hpp"
#include "idl/answers/commands.hpp"
#include "idl/answers/pair.hpp"
#include "idl/described_json.hpp"

namespace collided::view {
namespace {

using nlohmann::json;

void add_hit(json& text, const Hit& hit) {
  text["object"] = hit.object;
  text["distance"] = number(hit.distance_m);
  text["error"] = number(hit.error_m);
  text["point"] = numbers(hit.point);
  text["normal"] = numbers(hit.normal);
  if (hit.triangle != kNoTriangle) text["triangle"] = hit.triangle;
  text["point_error"] = number(hit.point_error_m);
}

json answer_head(double id, std::string_view ask, Verdict verdict, UndecidedReason reason) {
  json text{{"type", "answer"}, {"ask", ask}, {"id", id}, {"answer", name_of(verdict)}};
  if (verdict == Verdict::undecided) text["reason"] = name_of(reason);
  return text;
}

void add_cost(json& text, const Answers& answers) {
  const Cost& cost = answers.answers.front().cost;
  text["cost"] = {{"nodes", cost.nodes}, {"exact_tests", cost.exact_tests}, {"compute", seconds(answers.compute)}};
  if (answers.oldest_pose_age) text["age"] = seconds(*answers.oldest_pose_age);
}

/// Why there is not exactly one answer; empty if there is.
std::string problem_of(const Result<Answers>& answers) {
  if (!answers) return answers.error().message;
  return answers->answers.size() == 1 ? "" : "the server's answer does not fit the question";
}

}  // namespace

std::string ray_answer_text(double id, const RayQuestion& asked, const Result<Answers>& answers) {
  if (const std::string problem = problem_of(answers); !problem.empty()) return refused_text(id, problem);
  const Answer& answer = answers->answers.front();
  json text = answer_head(id, "ray", answer.verdict, answer.reason);
  text["origin"] = numbers(asked.origin);
  text["direction"] = numbers(asked.direction);
  if (!answer.hits.empty()) add_hit(text, answer.hits.front());
  add_cost(text, *answers);
  return text_of(text);
}

std::string hits_answer_text(double id, std::string_view ask, const Result<Answers>& answers) {
  if (const std::string problem = problem_of(answers); !problem.empty()) return refused_text(id, problem);
  constexpr std::size_t kMostTold = 100;
  const Answer& answer = answers->answers.front();
  json text = answer_head(id, ask, answer.verdict, answer.reason);
  json hits = json::array();
  for (const Hit& hit : answer.hits) {
    if (hits.size() == kMostTold) break;
    json& told = hits.emplace_back();
    add_hit(told, hit);
    if (hit.inside) told["inside"] = true;
    if (ask == "sweep") {
      told["time_low"] = number(hit.time_low);
      told["time_high"] = number(hit.time_high);
    }
  }
  text["hits"] = std::move(hits);
  text["left_out"] = answer.hits.size() - std::min(answer.hits.size(), kMostTold);
  add_cost(text, *answers);
  return text_of(text);
}

std::string nearest_answer_text(double id, const std::string& name, const Result<ClearanceAnswer>& answer) {
  if (!answer) return refused_text(id, answer.error().message);
  json text = answer_head(id, "nearest", answer->verdict, answer->reason);
  text["name"] = name;
  text["late"] = answer->late;
  text["tested"] = answer->tested;
  if (answer->pairs.empty()) return text_of(text);
  const ClearancePair& pair = answer->pairs.front();
  text["other"] = pair.b;
  text["clearance"] = number(pair.clearance_m);
  text["error"] = number(pair.error_m);
  text["on_a"] = numbers(pair.on_a);
  text["on_b"] = numbers(pair.on_b);
  return text_of(text);
}

std::string pair_answer_text(double id, const std::string& a, const std::string& b, const Result<PairAnswer>& answer) {
  if (!answer) return refused_text(id, answer.error().message);
  json text = json_of(*answer);
  text.update({{"type", "answer"}, {"ask", "pair"}, {"id", id}, {"a", a}, {"b", b}});
  return text_of(text);
}

std::string object_answer_text(double id, const Result<ObjectDetails>& object) {
  if (!object) return refused_text(id, object.error().message);
  json text = json_of(*object);
  text.update({{"type", "answer"}, {"ask", "object"}, {"id", id}});
  text["bounds"] = {numbers(object->bounds[0]), numbers(object->bounds[1])};
  if (object->age) text["age"] = seconds(*object->age);
  return text_of(text);
}

std::string owners_answer_text(double id, const Result<ObjectList>& moving) {
  if (!moving) return refused_text(id, moving.error().message);
  std::map<std::string_view, json> slots;
  for (const ListedObject& object : moving->objects) slots[object.publisher].push_back(slot_of(object.id));
  json owners = json::array();
  for (auto& [publisher, of] : slots) owners.push_back({{"publisher", publisher}, {"slots", std::move(of)}});
  return text_of({{"type", "answer"},
                  {"ask", "owners"},
                  {"id", id},
                  {"owners", owners},
                  {"left_out", moving->count - std::min<std::uint64_t>(moving->count, moving->objects.size())}});
}

std::string memory_answer_text(double id, const Result<std::uint64_t>& number) {
  if (!number) return refused_text(id, number.error().message);
  return text_of(
      {{"type", "answer"}, {"ask", "memory"}, {"id", id}, {"path", "memory?number=" + std::to_string(*number)}});
}

std::string sampled_answer_text(double id, const Result<std::string>& told) {
  if (!told) return refused_text(id, told.error().message);
  json text = json::parse(*told, nullptr, false);
  if (!text.is_object()) return refused_text(id, "the server's answer does not fit the question");
  text.update({{"type", "answer"}, {"ask", "sampled"}, {"id", id}});
  return text_of(text);
}

std::string refused_text(double id, std::string_view why) {
  return text_of({{"type", "refused"}, {"id", id}, {"why", why}});
}

}  // namespace collided::view
