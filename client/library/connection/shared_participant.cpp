#include "client/library/connection/shared_participant.hpp"

#include <condition_variable>
#include <map>
#include <mutex>
#include <stdexcept>

namespace collided::client {
namespace {

struct Joined {
  bool open = false;  // true until the participant's destructor has returned, later than the last owner's release
  std::weak_ptr<dds::Participant> participant;
  std::string interface;
  std::vector<std::string> peers;
  std::string keys;
  dds::Role role = dds::Role::client;
};

struct Registry {
  std::mutex mutex;
  std::condition_variable closed;
  std::map<int, Joined> domains;
};

// Never destroyed, since a Client may be a static object that is destroyed later.
Registry& registry() {
  static Registry& only = *new Registry;
  return only;
}

void leave_domain(int domain, dds::Participant* participant) {
  delete participant;
  const std::lock_guard lock(registry().mutex);
  registry().domains[domain].open = false;
  registry().closed.notify_all();
}

}  // namespace

std::shared_ptr<dds::Participant> join_domain(const ConnectOptions& options, dds::Role role) {
  std::unique_lock lock(registry().mutex);
  Joined& joined = registry().domains[options.domain];
  while (joined.open) {
    if (std::shared_ptr<dds::Participant> participant = joined.participant.lock()) {
      if (joined.interface != options.interface || joined.peers != options.peers) {
        throw std::invalid_argument("domain " + std::to_string(options.domain) +
                                    ": this process has joined it on interface '" + joined.interface +
                                    "'; one process uses one interface and one list of peers a domain");
      }
      if (joined.keys != options.keys) {
        throw std::invalid_argument("domain " + std::to_string(options.domain) + ": this process has joined it with " +
                                    (joined.keys.empty() ? "no keys" : "the keys '" + joined.keys + '\'') +
                                    "; one process uses one folder of keys a domain");
      }
      if (role == dds::Role::server && joined.role == dds::Role::client) {
        throw std::invalid_argument(
            "domain " + std::to_string(options.domain) +
            ": this process has joined it as a client, which other clients cannot find; what listens "
            "to them must be the first to join");
      }
      return participant;
    }
    registry().closed.wait(lock);  // Cyclone refuses a domain during its teardown
  }
  const dds::ParticipantOptions joining{.domain = options.domain,
                                        .role = role,
                                        .interface = options.interface,
                                        .peers = options.peers,
                                        .keys = options.keys};
  const std::shared_ptr<dds::Participant> participant(
      new dds::Participant(joining), [domain = options.domain](dds::Participant* last) { leave_domain(domain, last); });
  joined = {true, participant, options.interface, options.peers, options.keys, role};
  return participant;
}

}  // namespace collided::client
