#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/service/child_process.hpp"

namespace collided::testing_support {

/// Ports of this machine that are free now.
inline std::vector<int> free_ports(int count) {
  std::vector<int> ports, sockets;
  for (int i = 0; i < count; ++i) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    sockets.push_back(socket(AF_INET, SOCK_STREAM, 0));
    const bool is_bound = bind(sockets.back(), reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                          getsockname(sockets.back(), reinterpret_cast<sockaddr*>(&address), &size) == 0;
    ports.push_back(is_bound ? ntohs(address.sin_port) : 0);
  }
  for (const int one : sockets) close(one);
  return ports;
}

/// Debian's etcd-server, which only tests of it need.
inline bool has_etcd() { return access("/usr/bin/etcd", X_OK) == 0; }

/// A cluster of etcd on this machine, as an ordinary user's processes.
class EtcdCluster {
 public:
  /// more  arguments of each member; with --cert-file their clients speak TLS
  EtcdCluster(int members, std::string folder, std::vector<std::string> more = {})
      : folder_(std::move(folder)),
        more_(std::move(more)),
        has_tls_(std::ranges::find(more_, "--cert-file") != more_.end()),
        ports_(free_ports(2 * members)) {
    for (int i = 0; i < members; ++i) {
      all_ += (i == 0 ? "" : ",") + name(i) + "=" + peer_url(i);
      address_ += (i == 0 ? (has_tls_ ? "etcds://" : "etcd://") : ",") + ("127.0.0.1:" + std::to_string(port(i)));
    }
    members_.resize(static_cast<std::size_t>(members));
    for (int i = 0; i < members; ++i) start(i);
  }
  /// Whether all members serve.
  bool is_ready(std::chrono::milliseconds wait) const {
    for (const auto& one : members_)
      if (!one->says("serving client traffic", wait)) return false;
    return true;
  }
  /// For --authority.
  const std::string& address() const { return address_; }
  ChildProcess& member(int i) { return *members_[static_cast<std::size_t>(i)]; }
  /// The leader's number, as the members' logs say; -1: none is known.
  int leader() const {
    int found = -1;
    for (std::size_t i = 0; i < members_.size(); ++i)
      if (members_[i]->says("became leader at term", std::chrono::milliseconds(1))) found = static_cast<int>(i);
    return found;
  }

  /// Starts a member, again with what it has on disk where it was there before.
  void start(int i) {
    const std::string url = (has_tls_ ? "https://127.0.0.1:" : "http://127.0.0.1:") + std::to_string(port(i));
    std::vector<std::string> words{"/usr/bin/etcd",
                                   "--name",
                                   name(i),
                                   "--data-dir",
                                   folder_ + "/etcd-" + name(i),
                                   "--listen-client-urls",
                                   url,
                                   "--advertise-client-urls",
                                   url,
                                   "--listen-peer-urls",
                                   peer_url(i),
                                   "--initial-advertise-peer-urls",
                                   peer_url(i),
                                   "--initial-cluster",
                                   all_,
                                   "--heartbeat-interval",
                                   "50",
                                   "--election-timeout",
                                   "500",
                                   "--logger",
                                   "zap",
                                   "--log-outputs",
                                   "stdout"};
    words.insert(words.end(), more_.begin(), more_.end());
    auto& member = members_[static_cast<std::size_t>(i)];
    member.reset();
    member = std::make_unique<ChildProcess>(words, folder_, "etcd-" + name(i));
  }

 private:
  static std::string name(int i) { return "m" + std::to_string(i); }
  int port(int i) const { return ports_.at(2 * static_cast<std::size_t>(i)); }
  std::string peer_url(int i) const {
    return "http://127.0.0.1:" + std::to_string(ports_.at(2 * static_cast<std::size_t>(i) + 1));
  }
  const std::string folder_;
  const std::vector<std::string> more_;
  const bool has_tls_;
  const std::vector<int> ports_;
  std::string all_;
  std::string address_;
  std::vector<std::unique_ptr<ChildProcess>> members_;
};

}  // namespace collided::testing_support
