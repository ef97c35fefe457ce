#include "tests/studies/report/methods/peer_method.hpp"

#include <memory>

namespace collided::report {
using namespace engine;

std::filesystem::path problem_file(const Setting& setting, const std::string& study) {
  return std::filesystem::path(setting.scratch) / (study + ".problem");
}

void add_peer(std::vector<Method>& methods, const Setting& setting, const std::string& program,
              const std::string& option, const std::filesystem::path& problem, const std::string& series,
              const std::string& label) {
  if (setting.peers.empty()) return;
  auto peer = Peer::start(std::filesystem::path(setting.peers) / program, option, problem);
  if (!peer) return;
  struct State {
    Peer peer;
    int passes_left;
    bool dead = false;
  };
  auto state = std::make_shared<State>(State{*peer, setting.repeats()});
  methods.push_back({series, label, kUnknown, [state](std::vector<Answer>& answers) {
                       if (state->dead) return 0.0;
                       const std::optional<double> seconds = state->peer.pass();
                       state->dead = !seconds;
                       // The answers come with the last pass.
                       if (--state->passes_left == 0 && !state->dead) {
                         for (const PeerAnswer& a : state->peer.finish()) answers.push_back({a.yes != 0, a.value});
                       }
                       return seconds.value_or(0);
                     }});
}

}  // namespace collided::report
