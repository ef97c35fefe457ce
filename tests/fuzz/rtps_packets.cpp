// Packets of RTPS, changed in the ways that break parsers, at a running server:
//   rtps_packets SERVER CLI none|keys SECONDS
// The seeds are what a participant sends and receives that the server knows; with keys it shows those of another authority.
// The packets come under its GUID, so that the server looks for writers and readers that it has met, or under made-up ones.
// Prints a line and the seed; exits 1 where the server has ended or no longer answers, with the last packets.

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <random>

#include "tests/keys/key_folders.hpp"
#include "tests/keys/stranger.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/server_wire_asker.hpp"

namespace collided::testing_support {
namespace {

using namespace std::chrono_literals;
using keys::KeyRole;
using test::Bytes;

constexpr std::size_t kHeader = 20;
constexpr std::size_t kMostBytes = 65'000;

/// The packets of a capture in pcap's format, without the headers of IP and UDP.
std::vector<Bytes> read_capture(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  std::vector<Bytes> packets;
  constexpr std::size_t kFileHeader = 24, kRecordHeader = 16, kIpAndUdp = 28;
  for (std::size_t at = kFileHeader; at + kRecordHeader <= all.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, all.data() + at + 8, sizeof length);
    at += kRecordHeader;
    if (length > all.size() - at) break;
    if (length >= kIpAndUdp + kHeader && length < kMostBytes)
      packets.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(at + kIpAndUdp),
                           all.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return packets;
}

/// The submessages of a packet, each with its header; a last one may have any length.
std::vector<Bytes> submessages(const Bytes& packet) {
  std::vector<Bytes> parts;
  for (std::size_t at = kHeader; at + 4 <= packet.size();) {
    const bool is_little = (packet[at + 1] & 1) != 0;
    const std::size_t length = is_little ? packet[at + 2] | packet[at + 3] << 8 : packet[at + 2] << 8 | packet[at + 3];
    const std::size_t end = length == 0 ? packet.size() : std::min(packet.size(), at + 4 + length);
    parts.emplace_back(packet.begin() + static_cast<std::ptrdiff_t>(at),
                       packet.begin() + static_cast<std::ptrdiff_t>(end));
    at = end;
  }
  return parts;
}

class Mutator {
 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }
  bool chance(std::size_t one_in) { return below(one_in) == 0; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  template <class Range>
  const auto& any(const Range& range) {
    return range[below(std::size(range))];
  }

 public:
  Mutator(std::vector<Bytes> seeds, const test::Prefix& known, const test::Prefix& server, std::mt19937_64& random)
      : seeds_(std::move(seeds)), known_(known), server_(server), random_(random) {}

  Bytes make() {
    std::vector<Bytes> parts = submessages(any(seeds_));
    for (std::size_t i = 1 + below(4); i > 0 && !parts.empty(); --i) change(parts);
    // What comes late is dropped at once.
    for (Bytes& part : parts) {
      if (chance(2)) put_sequence_number(part);
    }
    Bytes packet{'R', 'T', 'P', 'S', 2, 1, 1, 0x10};
    const test::Prefix from = prefix();
    packet.insert(packet.end(), from.begin(), from.end());
    for (const Bytes& part : parts) packet.insert(packet.end(), part.begin(), part.end());
    if (chance(20)) packet[below(packet.size())] = byte();
    if (chance(20)) packet.resize(below(packet.size() + 1));
    if (packet.size() > kMostBytes) packet.resize(kMostBytes);
    return packet;
  }

 private:
  test::Prefix prefix() {
    test::Prefix made = chance(10) ? server_ : known_;
    if (chance(5)) std::generate(made.begin() + 6, made.end(), [&] { return byte(); });
    return made;
  }

  void change(std::vector<Bytes>& parts) {
    Bytes& part = parts[below(parts.size())];
    switch (below(10)) {
      case 0: part[below(part.size())] ^= static_cast<std::uint8_t>(1 << below(8)); break;
      case 1: put_number(part); break;
      case 2: part[1] = static_cast<std::uint8_t>((part[1] & 1) | below(16) << 1); break;  // same byte order
      case 3: part[0] = any(kKinds); break;
      case 4: put_entities(part); break;
      case 5: put_sequence_number(part); break;
      case 6: resize(part); break;
      case 7: parts.push_back(any(parts)); break;
      case 8: parts.insert(parts.begin(), insertion()); break;
      default: {
        const std::vector<Bytes> others = submessages(any(seeds_));
        if (!others.empty()) part = any(others);
      }
    }
  }
  void put_number(Bytes& part) {
    static constexpr std::uint32_t kNumbers[] = {
        0, 1, 2, 3, 4, 7, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xfffffff, 0xffffffff, 0xfffffffe};
    const std::uint32_t number = any(kNumbers);
    const std::size_t width = std::size_t{1} << below(3);
    if (part.size() >= 4) std::memcpy(part.data() + std::min(below(part.size()), part.size() - 4), &number, width);
  }
  /// Of the built-in readers and writers, where a submessage that has them has them.
  void put_entities(Bytes& part) {
    static constexpr std::array<std::uint8_t, 4> kWriters[] = {
        {0, 1, 0, 0xc2},    {0, 0, 3, 0xc2},    {0, 0, 4, 0xc2},    {0, 0, 2, 0xc2},    {0, 2, 0, 0xc2},
        {0, 2, 1, 0xc3},    {0xff, 2, 2, 0xc3}, {0xff, 1, 1, 0xc2}, {0xff, 0, 3, 0xc2}, {0xff, 0, 4, 0xc2},
        {0xff, 2, 0, 0xc2}, {0, 3, 0, 0xc3},    {0, 3, 1, 0xc3}};
    if (part.size() < 16) return;
    std::array<std::uint8_t, 4> writer = any(kWriters);
    // Of DATA both come after other fields; of acknowledgements and heartbeats they are the first.
    const std::size_t at = part[0] == 0x15 || part[0] == 0x16 ? 8 : 4;
    std::memcpy(part.data() + at + 4, writer.data(), writer.size());
    writer[3] = static_cast<std::uint8_t>(writer[3] == 0xc3 ? 0xc4 : 0xc7);
    if (chance(2)) std::memcpy(part.data() + at, writer.data(), writer.size());
  }
  void put_sequence_number(Bytes& part) {
    const std::size_t at = part[0] == 0x15 || part[0] == 0x16 ? 16 : 12;
    if (part.size() < at + 8) return;
    const std::uint32_t high_and_low[] = {chance(20) ? 1U : 0U, ++sequence_number_};
    std::memcpy(part.data() + at, high_and_low, sizeof high_and_low);
  }
  void resize(Bytes& part) {
    part.resize(4 + below(part.size()) + (chance(2) ? 0 : below(64)));
    const std::size_t length = part.size() - 4;
    part[2] = static_cast<std::uint8_t>(length);
    part[3] = static_cast<std::uint8_t>(length >> 8);
    part[1] |= 1;
  }
  Bytes insertion() {
    Bytes made = chance(2) ? Bytes{0x0e, 1, 12, 0} : Bytes{0x0c, 1, 20, 0, 0, 0, 0, 0, 2, 1, 1, 0x10};
    const test::Prefix other = chance(2) ? server_ : prefix();
    made.insert(made.end(), other.begin(), other.end());
    if (chance(3)) return test::handshake_request(known_, server_, ++sequence_number_);
    return made;
  }

  static constexpr std::uint8_t kKinds[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f,
                                            0x12, 0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34};
  std::vector<Bytes> seeds_;
  test::Prefix known_, server_;
  std::mt19937_64& random_;
  std::uint32_t sequence_number_ = 100;
};

/// Has the participants that are made next capture their packets. Its keys, if any, are in the configuration.
void configure(int domain, const std::string& keys, const std::string& capture) {
  std::string config = dds::domain_config({.domain = domain, .keys = keys});
  config.insert(config.rfind("</Domain>"), "<Tracing><PacketCaptureFile>" + capture + "</PacketCaptureFile></Tracing>");
  setenv("CYCLONEDDS_URI", config.c_str(), 1);
}

struct Run {
  std::string server, cli;
  bool has_keys;
  std::chrono::seconds length;
};

class Fuzzing {
 public:
  explicit Fuzzing(Run run) : run_(std::move(run)) {
    const ScratchFolder& folder = folder_;
    std::vector<std::string> words{run_.server, "--domain", std::to_string(domain_), "--state-dir", folder.path()};
    if (run_.has_keys) words.insert(words.end(), {"--keys", folders_.of("brain", {KeyRole::server})});
    server_ = std::make_unique<ChildProcess>(words, folder.path(), "server");
  }

  bool holds() {
    if (!server_->says("ready:", 20s)) return fails("does not start");
    const std::string capture = folder_.path() + "/capture";
    configure(domain_, run_.has_keys ? strangers_.of("stranger", {KeyRole::watcher}) : "", capture);
    // The roles of another authority give no right to topics.
    std::optional<dds::Participant> known_with_keys;
    std::optional<WireAsker> known;
    if (run_.has_keys) known_with_keys.emplace(dds::ParticipantOptions{.domain = domain_});
    else known.emplace(domain_);
    unsetenv("CYCLONEDDS_URI");
    if (known && !known->greet()) return fails("does not greet");
    std::this_thread::sleep_for(3s);
    const std::vector<Bytes> seeds = read_capture(capture);
    const auto prefixes = prefixes_of(seeds);
    if (prefixes.size() < 2) return fails("was not met");
    if (!answers()) return fails("does not answer");
    std::mt19937_64 random = oracle::seeded(std::random_device{}());
    Mutator mutator(seeds, prefixes[0], prefixes[1], random);
    return throw_packets(mutator) && (answers() || fails("no longer answers"));
  }

 private:
  /// Of the one that captured, which speaks first, and of the server.
  static std::vector<test::Prefix> prefixes_of(const std::vector<Bytes>& packets) {
    std::vector<test::Prefix> found;
    for (const Bytes& packet : packets) {
      test::Prefix prefix;
      std::copy_n(packet.begin() + 8, prefix.size(), prefix.begin());
      if (std::find(found.begin(), found.end(), prefix) == found.end()) found.push_back(prefix);
    }
    return found;
  }
  bool throw_packets(Mutator& mutator) {
    const test::UdpSocket socket;
    const std::vector<int> ports = test::udp_ports(server_->pid());
    const auto end = std::chrono::steady_clock::now() + run_.length;
    std::uint64_t count = 0;
    while (std::chrono::steady_clock::now() < end) {
      for (int i = 0; i < 200; ++i) {
        Bytes& packet = last_[count++ % last_.size()];
        packet = mutator.make();
        socket.send(packet, ports);
      }
      if (server_->wait(0ms) != -1) return fails("has ended");
      // So that little is lost on the way.
      std::this_thread::sleep_for(10ms);
    }
    std::printf("%llu packets\n", static_cast<unsigned long long>(count));
    return true;
  }
  bool answers() {
    std::vector<std::string> words{run_.cli, "--domain", std::to_string(domain_), "status", "--wait", "30s"};
    if (run_.has_keys) words.insert(words.end(), {"--keys", folders_.of("planner", {KeyRole::asker})});
    return ChildProcess(words, folder_.path(), "collide").wait(60s) == 0;
  }
  bool fails(const char* what) {
    std::fprintf(stderr, "the server %s, exit code %d:\n%s\n", what, server_->wait(0ms), server_->errors().c_str());
    for (const Bytes& packet : last_) {
      for (const std::uint8_t byte : packet) std::fprintf(stderr, "%02x", byte);
      if (!packet.empty()) std::fputc('\n', stderr);
    }
    return false;
  }

  Run run_;
  const ScratchFolder folder_;
  const int domain_ = own_domain();
  const test::KeyFolders folders_, strangers_;
  std::unique_ptr<ChildProcess> server_;
  std::array<Bytes, 400> last_;
};

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  const std::string form = argc == 5 ? argv[3] : "";
  if (form != "none" && form != "keys") {
    std::fprintf(stderr, "usage: rtps_packets SERVER CLI none|keys SECONDS\n");
    return 2;
  }
  collided::testing_support::Fuzzing fuzzing(
      {argv[1], argv[2], form == "keys", std::chrono::seconds(std::strtol(argv[4], nullptr, 10))});
  return fuzzing.holds() ? 0 : 1;
}
