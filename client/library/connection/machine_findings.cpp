#include "client/library/connection/machine_findings.hpp"

#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "idl/topics.hpp"

namespace collided::client {
namespace {

std::optional<std::uint64_t> number_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

/// The machine's network interfaces by name, and whether each is up.
std::map<std::string, bool> interfaces() {
  std::map<std::string, bool> found;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return found;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    found[entry->ifa_name] = (entry->ifa_flags & IFF_UP) != 0;
  }
  return found;
}

constexpr unsigned kPlaces = wire_contract::kMaxParticipantIndex + 1;

/// Adds the local ports in one of the kernel's tables of UDP sockets.
void add_udp_ports(const char* path, std::set<unsigned>& ports) {
  std::ifstream table(path);
  std::string line;
  std::getline(table, line);  // headings
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string number, local;
    words >> number >> local;
    unsigned port = 0;
    const std::size_t colon = local.rfind(':');
    if (colon == std::string::npos) continue;
    std::from_chars(local.data() + colon + 1, local.data() + local.size(), port, 16);
    ports.insert(port);
  }
}

/// Number of servers of the domain on this machine, in any namespace; also 0 if unknown.
unsigned places_taken(int domain) {
  // Unicast discovery port of participant i; source: OMG, "DDS Interoperability Wire Protocol" 2.2, 9.6.1.1.
  const unsigned first = 7'400U + 250U * static_cast<unsigned>(domain) + 10U;
  std::set<unsigned> ports;
  add_udp_ports("/proc/net/udp", ports);
  add_udp_ports("/proc/net/udp6", ports);
  unsigned taken = 0;
  for (unsigned i = 0; i < kPlaces; ++i)
    taken += ports.count(first + 2 * i) > 0 || ports.count(first + 2 * i + 1) > 0 ? 1 : 0;
  return taken;
}

}  // namespace

std::optional<Finding> interface_finding(const std::string& interface) {
  if (interface == "auto") return std::nullopt;
  const std::map<std::string, bool> known = interfaces();
  const auto found = known.find(interface);
  if (found != known.end() && found->second)
    return Finding{Health::ok, "interface", "interface '" + interface + "' is up", ""};
  if (found != known.end()) {
    return Finding{Health::fail, "interface", "interface '" + interface + "' is down",
                   "ip link set " + interface + " up"};
  }
  std::string names;
  for (const auto& [name, up] : known) names += (names.empty() ? "" : ", ") + name + (up ? "" : " (down)");
  return Finding{Health::fail, "interface", "this machine has no interface '" + interface + "'",
                 "--interface one of: " + names};
}

std::optional<Finding> buffer_finding() {
  constexpr std::uint64_t kAsked = 8 << 20;  // the size that dds.cpp requests
  constexpr std::uint64_t kPoseBytes = 60;   // in a batch
  const std::optional<std::uint64_t> most = number_in("/proc/sys/net/core/rmem_max");
  if (!most) return std::nullopt;
  const std::string size = "receive buffer up to " + std::to_string(*most) + " B";
  constexpr std::uint64_t kEnough = 1 << 20;  // a whole sample
  if (*most >= kEnough) return Finding{Health::ok, "buffer", size, ""};
  // The kernel also counts its overhead, which about doubles the size.
  return Finding{Health::warn, "buffer",
                 size + "; bursts above " + std::to_string(*most / 2 / kPoseBytes) + " poses may drop",
                 "sysctl -w net.core.rmem_max=" + std::to_string(kAsked)};
}

Finding places_finding(int domain) {
  const unsigned taken = places_taken(domain);
  const std::string text = std::to_string(taken) + " of " + std::to_string(kPlaces) + " places for servers of domain " +
                           std::to_string(domain) + " on this machine are taken";
  if (taken == kPlaces)
    return {Health::fail, "places", text + ": no server can start", "end some, or use another --domain"};
  if (taken > kPlaces * 3 / 4) return {Health::warn, "places", text, "use another --domain for some"};
  return {Health::ok, "places", text, ""};
}

std::optional<std::uint64_t> dropped_datagrams() {
  std::ifstream file("/proc/net/snmp");
  std::string names, values;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("Udp: ")) (names.empty() ? names : values) = line;
  }
  std::istringstream name_words(names), value_words(values);
  std::string name, value;
  while (name_words >> name && value_words >> value) {
    if (name != "RcvbufErrors") continue;
    std::uint64_t count = 0;
    std::from_chars(value.data(), value.data() + value.size(), count);
    return count;
  }
  return std::nullopt;
}

std::vector<std::string> servers_here() {
  std::vector<std::string> servers;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    const std::string pid = entry.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    std::string program, words;
    std::getline(std::ifstream(entry.path() / "comm") >> std::ws, program);
    if (program != "collided") continue;
    std::getline(std::ifstream(entry.path() / "cmdline"), words);
    while (!words.empty() && words.back() == '\0') words.pop_back();
    std::replace(words.begin(), words.end(), '\0', ' ');
    servers.push_back("pid " + pid + ": collided" + words.substr(std::min(words.find(' '), words.size())));
  }
  return servers;
}

}  // namespace collided::client
