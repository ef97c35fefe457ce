#include "client/library/connection/greeting_turn.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <random>
#include <string>
#include <thread>

#include "client/library/connection/local_process.hpp"

namespace collided::client {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kFirstLook{2};
constexpr milliseconds kLastLook{100};
constexpr int kTurnPatience = 30;  // factor on the wait for a server

/// Whether a socket got one of the domain's names. The names are abstract (they begin with a zero byte), so they leave
/// no files.
enum class Bound : std::uint8_t { yes, all_taken, impossible };

Bound bind_one(int socket, int domain) {
  for (unsigned turn = 0; turn < GreetingTurn::count(); ++turn) {
    const std::string name = "collided greeting " + std::to_string(domain) + ' ' + std::to_string(turn);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name.data(), name.size());
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0) return Bound::yes;
    if (errno != EADDRINUSE) return Bound::impossible;
  }
  return Bound::all_taken;
}

}  // namespace

unsigned GreetingTurn::count() { return 2 * std::max(1U, std::thread::hardware_concurrency()); }

GreetingTurn::GreetingTurn(const ConnectOptions& options) {
  if (options.interface != "lo") return;
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return;
  const Clock::time_point began = Clock::now();
  const nanoseconds patience = std::max(options.wait, nanoseconds(0));
  std::minstd_rand random(std::random_device{}());  // waiting programs poll at different times
  milliseconds look = kFirstLook;
  while (true) {
    const Bound bound = bind_one(socket, options.domain);
    if (bound == Bound::yes) {
      socket_ = socket;
      return;
    }
    const nanoseconds waited = Clock::now() - began;
    const bool has_more_time = !options.wait_is_limit && is_machine_crowded();
    if (bound == Bound::impossible || waited >= (has_more_time ? kTurnPatience * patience : patience)) break;
    const auto most = static_cast<unsigned>(look.count());
    std::this_thread::sleep_for(milliseconds(most / 2 + random() % (most / 2 + 1)));
    look = std::min(2 * look, kLastLook);
  }
  ::close(socket);
}

GreetingTurn::~GreetingTurn() {
  if (socket_ >= 0) ::close(socket_);
}

}  // namespace collided::client
