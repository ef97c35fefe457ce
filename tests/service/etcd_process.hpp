#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
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
  EtcdCluster(int members, std::string folder) : folder_(std::move(folder)), ports_(free_ports(2 * members)) {
    for (int i = 0; i < members; ++i) {
      all_ += (i == 0 ? "" : ",") + name(i) + "=" + peer_url(i);
      address_ +=
          (i == 0 ? "etcd://" : ",") + ("127.0.0.1:" + std::to_string(ports_.at(2 * static_cast<std::size_t>(i))));
    }
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

 private:
  static std::string name(int i) { return "m" + std::to_string(i); }
  std::string peer_url(int i) const {
    return "http://127.0.0.1:" + std::to_string(ports_.at(2 * static_cast<std::size_t>(i) + 1));
  }
  void start(int i) {
    const std::string url = "http://127.0.0.1:" + std::to_string(ports_.at(2 * static_cast<std::size_t>(i)));
    members_.push_back(std::make_unique<ChildProcess>(std::vector<std::string>{"/usr/bin/etcd",
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
                                                                               "stdout"},
                                                      folder_, "etcd-" + name(i)));
  }

  const std::string folder_;
  const std::vector<int> ports_;
  std::string all_;
  std::string address_;
  std::vector<std::unique_ptr<ChildProcess>> members_;
};

}  // namespace collided::testing_support
