#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/answers/explanation.hpp"
#include "idl/answers/pair.hpp"
#include "idl/commands.hpp"

// The functions Client::explain_...: they send the command `explain` (idl/commands.hpp) and read its answers.
namespace collided {
namespace {

using wire_contract::command::kExplain;

/// arguments  those of the command, without the deadline
template <class Explained>
Result<Explained> explained(Client& asked, nlohmann::json arguments, const ExplainOptions& options) {
  if (auto error = client::time_fault(kExplain, options.as_of, options.deadline)) return *error;
  arguments["deadline_ns"] = client::server_deadline(options.deadline, options.timeout).count();
  const Result<std::string> text = client::argument_text(kExplain, arguments);
  if (!text) return text.error();
  return client::read_answer(asked.command(kExplain, *text, {}, options.timeout), kExplain,
                             [](const nlohmann::json& answer) {
                               auto told = from_json<Explained>(answer);
                               if constexpr (std::is_same_v<Explained, ExplainedPair>)
                                 told.answer = from_json<PairAnswer>(answer);
                               return told;
                             });
}

}  // namespace

Result<ExplainedRay> Client::explain_ray(const RayQuestion& ray, const ExplainOptions& options) {
  const Vec3& o = ray.origin;
  const Vec3& d = ray.direction;
  if (!o.allFinite() || !d.allFinite()) return client::bad_input("explain: the ray has a number that is not finite");
  if (!(ray.length_m >= 0))
    return client::bad_input("explain: length_m is " + client::words(ray.length_m) + "; allowed 0 or more");
  nlohmann::json arguments{{"ray", {o.x(), o.y(), o.z(), d.x(), d.y(), d.z()}},
                           {"only", options.only},
                           {"skip", options.skip},
                           {"mask", options.mask},
                           {"most", options.most},
                           {"why_not", options.why_not},
                           {"as_of", wire_contract::text_of(client::instant_of(options.as_of))}};
  if (std::isfinite(ray.length_m)) arguments["length"] = ray.length_m;
  return explained<ExplainedRay>(*this, std::move(arguments), options);
}

Result<ExplainedPair> Client::explain_pair(const std::string& a, const std::string& b, const ExplainOptions& options) {
  if (options.last.count() < 0)
    return client::bad_input("explain: last is " + client::words(options.last) +
                             "; allowed 0 (all that is remembered) and more");
  nlohmann::json arguments{{"a", a}, {"b", b}, {"as_of", wire_contract::text_of(client::instant_of(options.as_of))}};
  if (options.last.count() > 0) arguments["last_ns"] = options.last.count();
  return explained<ExplainedPair>(*this, std::move(arguments), options);
}

Result<ExplainedStanding> Client::explain_standing(const std::string& name, const ExplainOptions& options) {
  return explained<ExplainedStanding>(*this, {{"standing", name}, {"most", options.most}, {"why_not", options.why_not}},
                                      options);
}

Result<ExplainedEvent> Client::explain_event(std::uint64_t sequence, EventsOf of, const ExplainOptions& options) {
  const char* const word = kEventsOfWords[static_cast<std::size_t>(of)];
  return explained<ExplainedEvent>(*this, {{"event", sequence}, {"of", word}}, options);
}

}  // namespace collided
