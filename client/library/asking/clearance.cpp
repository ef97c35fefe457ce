#include "client/library/asking/clearance.hpp"

#include <cmath>

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/answers/pair.hpp"
#include "idl/commands.hpp"

namespace collided::client {

Result<ClearanceAnswer> clearance(Connection& connection, const std::string& from, const ClearanceOptions& options) {
  if (auto error = time_fault("clearance", options.as_of, options.deadline)) return *error;
  if (!(options.nearer_m >= 0)) {
    return bad_input("clearance: nearer_m is " + words(options.nearer_m) + "; allowed 0 or more");
  }
  nlohmann::json arguments{
      {"from", from},
      {"to", options.to},
      {"skip", options.skip},
      {"most", options.most},
      {"with_filtered", options.with_filtered},
      {"certificate", options.certificate},
      {"as_of", wire_contract::text_of(instant_of(options.as_of))},
      {"deadline_ns",
       (options.progress ? options.deadline : server_deadline(options.deadline, options.timeout)).count()}};
  if (options.progress) arguments["progress"] = true;
  if (std::isfinite(options.nearer_m)) arguments["nearer_m"] = options.nearer_m;
  return read_answer<ClearanceAnswer>(
      command(connection, wire_contract::command::kClearance, arguments, options.timeout, options.progress),
      "clearance");
}

}  // namespace collided::client
