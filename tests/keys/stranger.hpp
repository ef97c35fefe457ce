#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dds.hpp"
#include "tests/service/eventually.hpp"

namespace collided::test {

using Bytes = std::vector<std::uint8_t>;
using Prefix = std::array<std::uint8_t, 12>;

/// The UDP ports that a process receives at.
inline std::vector<int> udp_ports(int pid) {
  std::set<std::string> inodes;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd", error)) {
    const std::string target = std::filesystem::read_symlink(file, error).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  std::vector<int> ports;
  std::ifstream table("/proc/net/udp");
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    const std::vector<std::string> word{std::istream_iterator<std::string>(words), {}};
    if (word.size() > 9 && inodes.contains(word[9])) ports.push_back(std::stoi(word[1].substr(9), nullptr, 16));
  }
  return ports;
}

/// A socket of this machine's loopback interface, as any program can have one.
class UdpSocket {
 public:
  UdpSocket() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in any = address(0);
    bind(socket_, reinterpret_cast<const sockaddr*>(&any), sizeof any);
  }
  ~UdpSocket() { close(socket_); }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  int port() const {
    sockaddr_in own{};
    socklen_t size = sizeof own;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
    return ntohs(own.sin_port);
  }
  void send(const Bytes& packet, const std::vector<int>& ports) const {
    for (const int port : ports) {
      const sockaddr_in to = address(port);
      sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }
  /// The next packet, or an empty one where none has come.
  Bytes receive() const {
    Bytes packet(65'536);
    const ssize_t size = recv(socket_, packet.data(), packet.size(), MSG_DONTWAIT);
    packet.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return packet;
  }

 private:
  static sockaddr_in address(int port) {
    sockaddr_in made{};
    made.sin_family = AF_INET;
    made.sin_port = htons(static_cast<std::uint16_t>(port));
    made.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return made;
  }
  int socket_;
};

/// A submessage DATA of RTPS from a built-in writer.
///
/// flags  0x05: data, 0x09: a key, 0x03: neither, but parameters; all little-endian
inline Bytes data_submessage(std::array<std::uint8_t, 4> reader, std::array<std::uint8_t, 4> writer,
                             std::uint32_t number, std::uint8_t flags, const Bytes& payload) {
  Bytes made{0x15, flags, 0, 0, 0, 0, 16, 0};
  made.insert(made.end(), reader.begin(), reader.end());
  made.insert(made.end(), writer.begin(), writer.end());
  const std::uint32_t high_and_low[] = {0, number};
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(high_and_low);
  made.insert(made.end(), bytes, bytes + sizeof high_and_low);
  made.insert(made.end(), payload.begin(), payload.end());
  const auto length = static_cast<std::uint16_t>(made.size() - 4);
  std::memcpy(made.data() + 2, &length, sizeof length);
  return made;
}

/// The message with which a participant asks another one for a handshake, with an empty token.
inline Bytes handshake_request(const Prefix& from, const Prefix& to, std::uint32_t number) {
  Bytes made{0, 1, 0, 0};
  const auto put_number = [&](std::uint32_t value) {
    while (made.size() % 4 != 0) made.push_back(0);
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&value);
    made.insert(made.end(), bytes, bytes + sizeof value);
  };
  const auto put_guid = [&](const Prefix& prefix, std::array<std::uint8_t, 4> entity) {
    made.insert(made.end(), prefix.begin(), prefix.end());
    made.insert(made.end(), entity.begin(), entity.end());
  };
  const auto put_text = [&](std::string_view text) {
    put_number(static_cast<std::uint32_t>(text.size() + 1));
    made.insert(made.end(), text.begin(), text.end());
    made.push_back(0);
  };
  put_guid(from, {0, 2, 1, 0xc3});
  put_number(number);
  put_number(0);
  put_guid({}, {});
  put_number(0);
  put_number(0);
  put_guid(to, {0, 0, 1, 0xc1});
  put_guid({}, {});
  put_guid({}, {});
  put_text("dds.sec.auth");
  put_number(1);
  put_text("DDS:Auth:PKI-DH:1.0+Req");
  put_number(0);
  put_number(0);
  return data_submessage({0, 2, 1, 0xc4}, {0, 2, 1, 0xc3}, number, 0x05, made);
}

/// A program without keys of the authority whose participants it attacks: DDS announces it with keys that it has made by
/// itself, and it puts packets of RTPS together by hand.
class Stranger {
 public:
  static constexpr std::array<std::uint8_t, 4> kHandshakeReader{0, 2, 1, 0xc4}, kHandshakeWriter{0, 2, 1, 0xc3};

  /// keys   empty: none
  /// ports  where others receive
  Stranger(int domain, const std::string& keys, std::vector<int> ports)
      : ports_(std::move(ports)), participant_(options(domain, keys)) {
    dds_guid_t guid;
    dds::check(dds_get_guid(participant_.get(), &guid), "own GUID");
    std::copy_n(guid.v, prefix_.size(), prefix_.begin());
  }

  const Prefix& prefix() const { return prefix_; }
  /// The participants that DDS has met, once they are so many; fewer after 10 s.
  std::set<Prefix> met(std::size_t count) const {
    const dds::Entity reader(
        dds::check(dds_create_reader(participant_.get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
                   "create reader of participants"));
    std::set<Prefix> found;
    eventually(
        [&] {
          void* sample = nullptr;
          dds_sample_info_t info;
          while (dds_take(reader.get(), &sample, &info, 1, 1) > 0) {
            Prefix other;
            std::copy_n(static_cast<const dds_builtintopic_participant_t*>(sample)->key.v, other.size(), other.begin());
            if (other != prefix_) found.insert(other);
            dds_return_loan(reader.get(), &sample, 1);
          }
          return found.size() >= count;
        },
        std::chrono::seconds(10));
    return found;
  }
  /// What DDS announces it with; empty where that has not come within 10 s.
  Bytes announcement() const {
    constexpr std::uint8_t kWriter[] = {0, 1, 0, 0xc2};
    Bytes packet;
    eventually(
        [&] {
          packet = socket_.receive();
          return std::search(packet.begin(), packet.end(), std::begin(kWriter), std::end(kWriter)) != packet.end();
        },
        std::chrono::seconds(10));
    return packet;
  }
  void send(const Bytes& packet) const { socket_.send(packet, ports_); }
  /// Sends submessages in a packet that comes from a participant with this prefix.
  void send_from(const Prefix& prefix, const Bytes& submessages) const {
    Bytes packet{'R', 'T', 'P', 'S', 2, 1, 1, 0x10};
    packet.insert(packet.end(), prefix.begin(), prefix.end());
    packet.insert(packet.end(), submessages.begin(), submessages.end());
    send(packet);
  }

 private:
  dds::ParticipantOptions options(int domain, const std::string& keys) const {
    dds::ParticipantOptions made{.domain = domain, .keys = keys};
    for (const int port : ports_) made.peers.push_back("127.0.0.1:" + std::to_string(port));
    made.peers.push_back("127.0.0.1:" + std::to_string(socket_.port()));
    return made;
  }

  UdpSocket socket_;
  std::vector<int> ports_;
  dds::Participant participant_;
  Prefix prefix_{};
};

/// An announcement with another participant's prefix.
inline Bytes with_prefix(Bytes packet, const Prefix& old_prefix, const Prefix& new_prefix) {
  for (auto at = packet.begin();;) {
    at = std::search(at, packet.end(), old_prefix.begin(), old_prefix.end());
    if (at == packet.end()) return packet;
    at = std::copy(new_prefix.begin(), new_prefix.end(), at);
  }
}

}  // namespace collided::test
