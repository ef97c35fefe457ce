#include "client/library/c/options.hpp"
#include "client/library/connection/described_status.hpp"

using namespace collided;
using namespace collided::c;

namespace {

/// Returns the status with its times also in nanoseconds, since members in seconds lack digits.
Result<void> hand_out_status(Client& client, char** answer) {
  const Result<ServerStatus> status = client.status();
  if (!status) return status.error();
  nlohmann::json json = json_of(*status);
  json["world_time_ns"] = status->world_time.count();
  json["step_lasting_ns"] = status->step_lasting.count();
  json["age_ns"] = status->age.count();
  for (std::size_t i = 0; i < status->publishers.size(); ++i)
    json["publishers"][i]["silent_ns"] = status->publishers[i].silent.count();
  return hand_out(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), answer);
}

}  // namespace

extern "C" {

int collided_connect(const char* options, collided_client** client, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    *client = nullptr;
    const Result<ConnectOptions> made =
        text(options).empty() ? ConnectOptions::from_environment() : options_of<ConnectOptions>(options, "connect");
    if (!made) return made.error();
    Result<Client> connected = Client::connect(*made);
    if (!connected) return connected.error();
    *client = new collided_client{std::move(*connected)};
    return {};
  });
}

void collided_close(collided_client* client) { delete client; }

int collided_command(collided_client* client, const char* name, const char* arguments, const collided_part* parts,
                     size_t part_count, int64_t timeout_ns, char** answer, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (answer) *answer = nullptr;
    if (text(name) == "status") return hand_out_status(client->client, answer);
    const Result<Shape> shape = shape_of(parts, part_count);
    if (!shape) return shape.error();
    const std::chrono::nanoseconds timeout(timeout_ns != 0 ? timeout_ns : 10'000'000'000);
    const Result<std::string> said = client->client.command(text(name), text(arguments), *shape, timeout);
    if (!said) return said.error();
    return hand_out(*said, answer);
  });
}

}  // extern "C"
