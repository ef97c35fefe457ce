#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "collided/diagnosis.hpp"
#include "idl/dds.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using testing_support::ChildProcess;

class ServerDoctor : public testing_support::ServerTest {
 protected:
  /// By what they are about.
  std::map<std::string, Finding> findings(std::chrono::nanoseconds wait = 5s, const std::string& interface = "lo") {
    std::map<std::string, Finding> all;
    for (const Finding& finding : diagnose({.domain = domain_, .interface = interface, .wait = wait}))
      all[finding.about] = finding;
    return all;
  }
  /// `collide doctor` in a shell, after some words that set the scene.
  Ended doctor(const std::string& before = {}) {
    const std::string line = before + " exec '" + COLLIDED_CLI + "' --domain " + std::to_string(domain_) +
                             " doctor --fields health,about,text,remedy";
    ChildProcess process({"/bin/bash", "-c", line}, folder_.path(), "doctor");
    const int code = process.wait(60s);
    return {code, process.output(), process.errors()};
  }
};

TEST_F(ServerDoctor, AHealthyServerIsAllRight) {
  ChildProcess& server = start();
  const std::map<std::string, Finding> all = findings();
  for (const char* about : {"interface", "places", "server", "clock", "round_trip"}) {
    ASSERT_EQ(all.count(about), 1U) << about;
    EXPECT_EQ(all.at(about).health, Health::ok) << all.at(about).text;
    EXPECT_EQ(all.at(about).remedy, "");
  }
  EXPECT_NE(all.at("server").text.find("(pid " + std::to_string(server.pid()) + ")"), std::string::npos)
      << all.at("server").text;
  EXPECT_NE(all.at("round_trip").text.find("1000 of 1000 back"), std::string::npos) << all.at("round_trip").text;
  EXPECT_EQ(doctor().code, 0);
}

/// Datagrams that Linux has dropped in this network namespace for full buffers.
std::uint64_t dropped_so_far() {
  std::ifstream file("/proc/net/snmp");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("Udp: ")) lines.push_back(line);
  }
  if (lines.size() != 2) return 0;
  std::istringstream names(lines[0]), values(lines[1]);
  for (std::string name, value; names >> name && values >> value;) {
    if (name == "RcvbufErrors") return std::stoull(value);
  }
  return 0;
}

// Somebody sends to a socket that nobody reads.
TEST_F(ServerDoctor, DatagramsThatAreDroppedMeanwhileAreCounted) {
  start();
  const int deaf = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::bind(deaf, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  ASSERT_EQ(::getsockname(deaf, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const int least = 1;
  ASSERT_EQ(::setsockopt(deaf, SOL_SOCKET, SO_RCVBUF, &least, sizeof least), 0);
  const int sender = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::atomic<bool> done{false};
  const std::uint64_t before = dropped_so_far();
  std::thread sending([&] {
    while (!done) {
      static_cast<void>(
          ::sendto(sender, "too much", 8, 0, reinterpret_cast<const sockaddr*>(&address), sizeof address));
      std::this_thread::sleep_for(1ms);
    }
  });
  const std::map<std::string, Finding> all = findings();
  done = true;
  sending.join();
  const std::uint64_t after = dropped_so_far();
  ::close(deaf);
  ::close(sender);
  ASSERT_EQ(all.count("losses"), 1U);
  const std::string& text = all.at("losses").text;
  EXPECT_EQ(all.at("losses").health, Health::warn) << text;
  ASSERT_TRUE(text.ends_with(" datagrams dropped on this machine meanwhile, for full buffers")) << text;
  EXPECT_GE(std::stoull(text), 1U) << text;
  EXPECT_LE(std::stoull(text), after - before) << text;
}

// What is asked a thousand times is the empty question of a connection's beginning, whole.
TEST_F(ServerDoctor, ItsRoundTripsAreGreetings) {
  start();
  const dds::Participant listener({.domain = domain_, .role = dds::Role::server, .process_domain = domain_ + 100'000});
  const dds::Topic<wire::Query> topic(listener, "collided");
  std::mutex mutex;
  std::size_t heard = 0;
  constexpr std::uint64_t kTurn = 1'024;  // the numbers of requests that follow on each other differ by so much
  std::set<std::uint64_t> turns;
  std::multiset<std::string> unlike;
  const dds::Reader<wire::Query> reader(
      topic, {.data = [&](dds::Taker<wire::Query> taker) {
        dds::Sample<wire::Query> query;
        while (taker.take(query)) {
          if (!query.info().valid_data) continue;
          const std::lock_guard lock(mutex);
          ++heard;
          turns.insert(query->request / kTurn);
          const bool is_greeting = query->kind == static_cast<std::uint8_t>(wire_contract::QuestionKind::hello);
          if (!is_greeting || query->chunk_count != 1 || query->chunk_index != 0 || query->points._length != 0) {
            unlike.insert("kind " + std::to_string(query->kind) + ", chunk " + std::to_string(query->chunk_index) +
                          " of " + std::to_string(query->chunk_count) + ", points " +
                          std::to_string(query->points._length));
          }
        }
      }});
  findings();
  // This reader may come to be known after the first of them: from the one that it heard first on it hears each.
  EXPECT_TRUE(test::eventually([&] {
    const std::lock_guard lock(mutex);
    return !turns.empty() && *turns.rbegin() >= 1'000 && turns.size() == *turns.rbegin() - *turns.begin() + 1;
  })) << heard
      << " heard";
  const std::lock_guard lock(mutex);
  EXPECT_EQ(unlike, std::multiset<std::string>{"kind " +
                                               std::to_string(static_cast<int>(wire_contract::QuestionKind::command)) +
                                               ", chunk 0 of 1, points 0"})
      << "only the server's figures are asked for beside them, once";
}

TEST_F(ServerDoctor, WithoutAServerItSaysWhichOnesThereAre) {
  start({"--namespace", "other"});
  const std::map<std::string, Finding> all = findings(200ms);
  ASSERT_EQ(all.count("server"), 1U);
  EXPECT_EQ(all.at("server").health, Health::fail);
  // A machine that is crowded waits longer than it was asked to, and says how long.
  const std::string& text = all.at("server").text;
  double waited = 0;
  char unit[3] = {};
  ASSERT_EQ(std::sscanf(text.c_str(), "no collided answered in %lf %2[ms] on domain", &waited, unit), 2) << text;
  EXPECT_GE(std::string(unit) == "ms" ? waited : 1000 * waited, 200) << text;
  EXPECT_TRUE(text.ends_with(" on domain " + std::to_string(domain_) + ", namespace 'collided'")) << text;
  EXPECT_NE(all.at("server").remedy.find("on this machine: pid " + std::to_string(servers_[0]->pid()) +
                                         ": collided --domain "),
            std::string::npos)
      << all.at("server").remedy;
  EXPECT_NE(all.at("server").remedy.find("--namespace other"), std::string::npos);
  EXPECT_EQ(doctor("COLLIDED_NAMESPACE=nobody").code, 4);
}

// The second one starts while the first is held, so that neither knows of the other.
TEST_F(ServerDoctor, TwoServersOfOneNamespaceAreFound) {
  ChildProcess& first = start();
  first.signal(SIGSTOP);
  const testing_support::ScratchFolder elsewhere;
  ChildProcess second({COLLIDED_SERVER, "--domain", std::to_string(domain_), "--state-dir", elsewhere.path()},
                      elsewhere.path(), "second");
  ASSERT_TRUE(second.says("ready:", 20s)) << second.errors();
  first.signal(SIGCONT);
  const std::map<std::string, Finding> all = findings();
  ASSERT_EQ(all.count("server"), 1U);
  EXPECT_EQ(all.at("server").health, Health::fail) << all.at("server").text;
  EXPECT_TRUE(all.at("server").text.starts_with("2 servers share namespace 'collided' (pid ")) << all.at("server").text;
  for (const ChildProcess* server :
       {static_cast<const ChildProcess*>(&first), static_cast<const ChildProcess*>(&second)}) {
    EXPECT_NE(all.at("server").text.find(std::to_string(server->pid())), std::string::npos);
  }
  EXPECT_EQ(doctor().code, 1);
}

TEST_F(ServerDoctor, AnInterfaceThatIsNotThereIsNamedWithThoseThatAre) {
  const std::map<std::string, Finding> all = findings(100ms, "eth_none");
  ASSERT_EQ(all.count("interface"), 1U);
  EXPECT_EQ(all.at("interface").health, Health::fail);
  EXPECT_EQ(all.at("interface").text, "this machine has no interface 'eth_none'");
  EXPECT_TRUE(all.at("interface").remedy.starts_with("--interface one of: ")) << all.at("interface").remedy;
  EXPECT_NE(all.at("interface").remedy.find("lo"), std::string::npos);
}

/// Holds the ports of a domain's participants on this machine, as so many programs would.
class TakenPlaces {
 public:
  explicit TakenPlaces(int domain) : domain_(domain) {}
  ~TakenPlaces() {
    for (const int socket : sockets_) ::close(socket);
  }
  void take(unsigned count) {
    while (sockets_.size() < count) {
      const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port =
          htons(static_cast<std::uint16_t>(7'410 + 250 * domain_ + 2 * static_cast<int>(sockets_.size())));
      sockets_.push_back(socket);
      // Any program may have been given such a port for a while.
      const auto is_bound = [&] {
        const int refused = ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address);
        EXPECT_TRUE(refused == 0 || errno == EADDRINUSE) << std::strerror(errno);
        return refused == 0;
      };
      ASSERT_TRUE(test::eventually(is_bound, std::chrono::seconds(30))) << ntohs(address.sin_port);
    }
  }

 private:
  int domain_;
  std::vector<int> sockets_;
};

TEST_F(ServerDoctor, WhenNoPlaceIsLeftNoServerCanStart) {
  EXPECT_EQ(findings(100ms).at("places").health, Health::ok);
  TakenPlaces places(domain_);
  places.take(100);
  EXPECT_EQ(findings(100ms).at("places").health, Health::warn);
  places.take(121);
  const Finding full = findings(100ms).at("places");
  EXPECT_EQ(full.health, Health::fail);
  EXPECT_NE(full.text.find("121 of 121 places"), std::string::npos) << full.text;
  const Ended refused = run({"--domain", std::to_string(domain_), "--state-dir", folder_.path()});
  EXPECT_EQ(refused.code, 2) << "and that is so";
}

TEST_F(ServerDoctor, AServersClockThatIsOffIsToldWithItsSign) {
#ifdef COLLIDED_SHIFTED_CLOCK
  std::int64_t shift_ns = 0;
  const auto bytes = [&] { return std::string(reinterpret_cast<const char*>(&shift_ns), sizeof shift_ns); };
  const std::string file = folder_.write("shift", bytes());
  // The server alone gets it.
  ::setenv("LD_PRELOAD", COLLIDED_SHIFTED_CLOCK, 1);
  ::setenv("COLLIDED_CLOCK_SHIFT", file.c_str(), 1);
  start();
  ::unsetenv("LD_PRELOAD");
  ::unsetenv("COLLIDED_CLOCK_SHIFT");
  shift_ns = 90'000'000'000;
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary) << bytes() << std::flush;
  const std::map<std::string, Finding> all = findings();
  ASSERT_EQ(all.count("clock"), 1U) << all.at("server").text;
  EXPECT_EQ(all.at("clock").health, Health::warn);
  EXPECT_EQ(all.at("clock").text.find("the server's clock is "), 0U) << all.at("clock").text;
  EXPECT_NE(all.at("clock").text.find(" ahead; times"), std::string::npos) << all.at("clock").text;
#else
  GTEST_SKIP() << "sanitizers want to be loaded first";
#endif
}

// Two processes that publish, of which one has another clock.
TEST_F(ServerDoctor, PublishersStampsAreCompared) {
#ifdef COLLIDED_SHIFTED_CLOCK
  start();
  const std::int64_t shift_ns = 300'000'000;
  const std::string file =
      folder_.write("shift", std::string(reinterpret_cast<const char*>(&shift_ns), sizeof shift_ns));
  const auto publish = [&](const std::string& name, const std::string& before) {
    const std::string line = before + " exec '" + COLLIDED_CLI + "' --domain " + std::to_string(domain_) +
                             " publish --spheres 3 --round --rate 50 --name " + name + " --as " + name + " --for 60s";
    return std::make_unique<ChildProcess>(std::vector<std::string>{"/bin/bash", "-c", line}, folder_.path(), name);
  };
  const auto heard = [&] {
    const auto all = findings();
    return all.contains("publisher_clocks") ? all.at("publisher_clocks").text : std::string();
  };
  const auto one = publish("here", "");
  const auto same = publish("beside", "");
  EXPECT_TRUE(test::eventually([&] { return heard().starts_with("the stamps of 2 publishers agree within"); }, 20s));
  const auto other = publish("there", "LD_PRELOAD='" COLLIDED_SHIFTED_CLOCK "' COLLIDED_CLOCK_SHIFT='" + file + "'");
  const std::string begins = "the stamps of 'there' are ";
  EXPECT_TRUE(test::eventually([&] { return heard().starts_with(begins); }, 20s));
  const Finding finding = findings()["publisher_clocks"];
  EXPECT_EQ(finding.health, Health::warn);
  ASSERT_TRUE(finding.text.starts_with(begins)) << finding.text;
  EXPECT_NEAR(std::stod(finding.text.substr(begins.size())), 300, 40) << finding.text;
  EXPECT_NE(finding.remedy.find("--clock-error 3"), std::string::npos) << finding.remedy;
#else
  GTEST_SKIP() << "sanitizers want to be loaded first";
#endif
}

// A limit of the kernel's, replaced for one process in a mount namespace of its own.
TEST_F(ServerDoctor, SmallBuffersAreToldWithTheCommandThatRaisesThem) {
  const std::string small = folder_.write("rmem_max", "212992\n");
  const std::string mounted = "unshare -m bash -c 'mount --bind " + small + " /proc/sys/net/core/rmem_max";
  ChildProcess probe({"/bin/bash", "-c", mounted + "'"}, folder_.path(), "probe");
  if (probe.wait(10s) != 0) GTEST_SKIP() << "no mount namespaces here: " << probe.errors();
  start();
  const std::string line = mounted + " && exec " + COLLIDED_CLI + " --domain " + std::to_string(domain_) +
                           " doctor --fields health,about,text,remedy'";
  ChildProcess process({"/bin/bash", "-c", line}, folder_.path(), "doctor");
  EXPECT_EQ(process.wait(60s), 0) << "a warning is no failure";
  EXPECT_NE(process.output().find("warn\tbuffer\treceive buffer up to 212992 B; bursts above 1774 poses may "
                                  "drop\tsysctl -w net.core.rmem_max=8388608"),
            std::string::npos)
      << process.output();
}

TEST_F(ServerDoctor, AConfigurationOfDdsItselfIsTold) {
  start();
  const Ended ended =
      doctor("CYCLONEDDS_URI='<Domain id=\"any\"><Discovery><ExternalDomainId>" + std::to_string(domain_) +
             "</ExternalDomainId><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain>'");
  EXPECT_NE(ended.output.find("warn\tconfiguration\tCYCLONEDDS_URI is set"), std::string::npos)
      << ended.output << ended.errors;
}

}  // namespace
}  // namespace collided
