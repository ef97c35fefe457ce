#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "client/library/connection/errors.hpp"
#include "collided/fleet.hpp"

namespace collided {
namespace {

using client::words;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// "a (pid 12 on north)".
std::string who(const FleetMember& member) {
  return "'" + member.name + "' (pid " + std::to_string(member.pid) + " on " + member.host + ')';
}

std::string list_of(const std::vector<const FleetMember*>& members) {
  std::string list;
  for (const FleetMember* member : members) list += (list.empty() ? "" : ", ") + who(*member);
  return list;
}

/// Whether all members say the same; those with nothing to say do not count.
template <class Say>
bool agree(const std::vector<FleetMember>& members, const Say& say, const decltype(say(members[0]))& nothing) {
  std::set<std::decay_t<decltype(nothing)>> said;
  for (const FleetMember& member : members) {
    if (say(member) != nothing) said.insert(say(member));
  }
  return said.size() <= 1;
}

void find_primaries(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  std::vector<const FleetMember*> primaries;
  for (const FleetMember& member : members) {
    if (member.role == FleetRole::primary) primaries.push_back(&member);
  }
  if (primaries.size() > 1) {
    findings.push_back({Health::fail, "primaries",
                        std::to_string(primaries.size()) + " primaries: " + list_of(primaries) +
                            "; answers may differ, and events come twice",
                        "stop all but one, or give each a --namespace of its own"});
  }
  if (primaries.empty() && !members.empty())
    findings.push_back(
        {Health::fail, "primaries", "no primary: nobody answers", "start one without --standby-of and --replica-of"});
}

void find_versions(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  if (agree(
          members, [](const FleetMember& member) { return member.version_text; }, std::string()))
    return;
  std::string text = "different versions:";
  for (const FleetMember& member : members) text += " '" + member.name + "' is " + member.version_text + ';';
  text.pop_back();
  findings.push_back({Health::warn, "versions", text, "install the same version on all machines"});
}

void find_scenes(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  if (agree(
          members, [](const FleetMember& member) { return member.scene_fingerprint; }, std::uint64_t{0}))
    return;
  std::vector<const FleetMember*> all;
  for (const FleetMember& member : members) all.push_back(&member);
  findings.push_back({Health::fail, "scenes", "different scenes: " + list_of(all) + " do not hold the same triangles",
                      "start all of them with the same files; a scene that is being loaded is on one of them first"});
}

/// Worlds can only be compared where they are those of one instant.
void find_worlds(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) {
      const FleetMember& a = members[i];
      const FleetMember& b = members[j];
      if (a.hash_time.count() == 0 || a.hash_time != b.hash_time || a.world_hash == b.world_hash) continue;
      findings.push_back(
          {Health::fail, "worlds",
           "different worlds: " + who(a) + " and " + who(b) + " do not hold the same objects at the same places",
           "their logs say which object differs first"});
    }
  }
}

/// Servers on one machine have one clock: what they seem to be apart is how long their messages took, and the least counts.
void find_clocks(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  constexpr nanoseconds kNoticed = milliseconds(20);
  std::map<std::string_view, const FleetMember*> of_machine;
  for (const FleetMember& member : members) {
    const FleetMember*& quickest = of_machine[member.host];
    if (quickest == nullptr || quickest->clock_ahead < member.clock_ahead) quickest = &member;
  }
  const FleetMember* behind = nullptr;
  const FleetMember* ahead = nullptr;
  for (const auto& [machine, member] : of_machine) {
    if (behind == nullptr || member->clock_ahead < behind->clock_ahead) behind = member;
    if (ahead == nullptr || member->clock_ahead > ahead->clock_ahead) ahead = member;
  }
  if (ahead == nullptr || ahead->clock_ahead - behind->clock_ahead < kNoticed) return;
  findings.push_back({Health::warn, "clocks",
                      "clocks apart: that of " + who(*ahead) + " is " +
                          words(ahead->clock_ahead - behind->clock_ahead) + " ahead of that of " + who(*behind),
                      "let all machines follow one time server (PTP, chrony)"});
}

void find_alarms(const std::vector<FleetMember>& members, std::vector<Finding>& findings) {
  for (const FleetMember& member : members) {
    for (std::string_view left = member.alarm; !left.empty();) {
      const std::size_t end = std::min(left.find('\n'), left.size());
      findings.push_back({Health::fail, "alarm", who(member) + ": " + std::string(left.substr(0, end)), ""});
      left.remove_prefix(std::min(end + 1, left.size()));
    }
  }
}

}  // namespace

std::vector<Finding> fleet_findings(const std::vector<FleetMember>& members) {
  std::vector<Finding> findings;
  find_primaries(members, findings);
  find_versions(members, findings);
  find_scenes(members, findings);
  find_worlds(members, findings);
  find_clocks(members, findings);
  find_alarms(members, findings);
  return findings;
}

}  // namespace collided
