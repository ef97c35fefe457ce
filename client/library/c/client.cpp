#include <cstdlib>

#include "client/library/c/values.hpp"

using namespace collided;
using namespace collided::c;

namespace {

Result<ConnectOptions> connect_options(const collided_connect_options* options) {
  if (!options) return ConnectOptions::from_environment();
  const collided_connect_options given = taken(options);
  ConnectOptions made;
  made.domain = given.domain;
  if (given.name_space && *given.name_space) made.name_space = given.name_space;
  if (given.interface_name && *given.interface_name) made.interface = given.interface_name;
  if (given.wait_ns != 0) made.wait = std::chrono::nanoseconds(given.wait_ns);
  if (given.keys) made.keys = given.keys;
  if (given.peer_count > 0 && !given.peers) return missing("peers");
  for (std::size_t i = 0; i < given.peer_count; ++i) made.peers.push_back(text(given.peers[i]));
  return made;
}

collided_status status_of(const ServerStatus& said) {
  collided_status status{};
  status.pid = said.pid;
  put_text(said.name_space, status.name_space);
  put_text(said.version_text, status.version_text);
  put_text(said.state, status.state);
  status.epoch = said.epoch;
  status.version = said.version;
  status.world_time_ns = said.world_time.count();
  status.static_triangles = said.static_triangles;
  status.poses_applied = said.poses_applied;
  status.poses_dropped = said.poses_dropped;
  status.questions_answered = said.questions_answered;
  status.questions_refused = said.questions_refused;
  status.undecided_answers = said.undecided_answers;
  status.objects = said.objects;
  status.moving = said.moving;
  status.contacts = said.contacts;
  status.contacts_truncated = said.contacts_truncated ? 1 : 0;
  status.step_lasting_ns = said.step_lasting.count();
  return status;
}

collided_pair_answer pair_answer_of(const PairAnswer& said) {
  collided_pair_answer answer{};
  answer.verdict = static_cast<std::int32_t>(said.verdict);
  answer.reason = static_cast<std::int32_t>(said.reason);
  answer.stale = said.stale ? 1 : 0;
  answer.contained = static_cast<std::int32_t>(said.contained);
  answer.a_triangle = said.a_triangle;
  answer.b_triangle = said.b_triangle;
  answer.version = said.version;
  answer.distance_m = said.distance_m;
  answer.depth_m = said.depth_m;
  answer.error_m = said.error_m;
  put(said.normal, answer.normal);
  put(said.on_a, answer.on_a);
  put(said.on_b, answer.on_b);
  answer.point_error_m = said.point_error_m;
  put(said.point, answer.point);
  return answer;
}

}  // namespace

extern "C" {

int collided_connect(const collided_connect_options* options, collided_client** client, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    *client = nullptr;
    const Result<ConnectOptions> made = connect_options(options);
    if (!made) return made.error();
    Result<Client> connected = Client::connect(*made);
    if (!connected) return connected.error();
    *client = new collided_client{std::move(*connected)};
    return {};
  });
}

void collided_close(collided_client* client) { delete client; }

int collided_get_status(collided_client* client, collided_status* status, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    const Result<ServerStatus> said = client->client.status();
    if (!said) return said.error();
    give(status_of(*said), status);
    return {};
  });
}

int collided_pair(collided_client* client, const char* a, const char* b, int64_t timeout_ns,
                  collided_pair_answer* answer, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    PairOptions options;
    if (timeout_ns != 0) options.timeout = std::chrono::nanoseconds(timeout_ns);
    const Result<PairAnswer> said = client->client.pair(text(a), text(b), options);
    if (!said) return said.error();
    give(pair_answer_of(*said), answer);
    return {};
  });
}

int collided_command(collided_client* client, const char* name, const char* json_arguments, int64_t timeout_ns,
                     char** answer, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (answer) *answer = nullptr;
    const std::chrono::nanoseconds timeout(timeout_ns != 0 ? timeout_ns : 10'000'000'000);
    const Result<std::string> said = client->client.command(text(name), text(json_arguments), {}, timeout);
    if (!said) return said.error();
    if (!answer) return {};
    *answer = static_cast<char*>(std::malloc(said->size() + 1));
    if (!*answer) return Error{ErrorCode::internal, "no memory for the answer", ""};
    std::memcpy(*answer, said->c_str(), said->size() + 1);
    return {};
  });
}

void collided_free_text(char* text) { std::free(text); }

}  // extern "C"
