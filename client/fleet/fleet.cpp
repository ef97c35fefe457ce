#include "collided/fleet.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>

#include "client/library/connection/errors.hpp"
#include "client/library/connection/server_pulse.hpp"
#include "client/library/connection/shared_participant.hpp"
#include "idl/clocks.hpp"
#include "idl/dds.hpp"

namespace collided {
namespace {

using client::Clock;
using std::chrono::nanoseconds;

/// Long enough for two messages of each server, of which the second is fresh: what DDS kept of it may be old.
constexpr nanoseconds kListen(3 * wire_contract::kMemberPeriodNs);

FleetRole role_in(const wire::Member& member) {
  switch (static_cast<wire_contract::MemberRole>(member.role)) {
    case wire_contract::MemberRole::primary: return FleetRole::primary;
    case wire_contract::MemberRole::standby: return FleetRole::standby;
    default: return FleetRole::replica;  // one of a later version decides nothing either
  }
}

FleetMember decode(const wire::Member& member) {
  FleetMember decoded;
  decoded.server = member.server;
  decoded.epoch = member.epoch;
  decoded.role = role_in(member);
  decoded.state = client::state_name(member.state);
  decoded.name = member.name;
  decoded.host = member.host;
  decoded.pid = member.pid;
  decoded.version_text = member.server_version;
  decoded.started = nanoseconds(member.started_ns);
  decoded.up = nanoseconds(member.clock_ns - member.started_ns);
  decoded.version = member.version;
  decoded.lag = nanoseconds(member.lag_ns);
  decoded.scene_fingerprint = member.scene_fingerprint;
  if (member.digest_time_ns != 0) {
    decoded.hash_time = nanoseconds(member.digest_time_ns);
    decoded.world_hash = wire_contract::digest_hash(dds::view(member.digest));
  }
  decoded.alarm = member.alarm;
  return decoded;
}

/// Takes what servers say of themselves, until it was listened for so long.
class FleetListener {
 public:
  FleetListener(const dds::Participant& participant, const std::string& name_space)
      : topic_(participant, name_space), reader_(topic_), waitset_(participant) {
    waitset_.attach(reader_, 1);
  }

  std::vector<FleetMember> listen(Clock::time_point deadline) {
    while (Clock::now() < deadline) {
      waitset_.wait(std::max<std::int64_t>(0, nanoseconds(deadline - Clock::now()).count()));
      take();
    }
    std::vector<FleetMember> members;
    for (auto& [server, heard] : members_) members.push_back(std::move(heard));
    std::ranges::sort(members, {}, [](const FleetMember& member) { return std::pair(member.name, member.server); });
    return members;
  }

 private:
  void take() {
    while (reader_.take(sample_)) {
      if (sample_.info().instance_state != DDS_ALIVE_INSTANCE_STATE) members_.erase(sample_->server);
      if (!sample_.info().valid_data || sample_.info().instance_state != DDS_ALIVE_INSTANCE_STATE) continue;
      const auto before = members_.find(sample_->server);
      const bool is_first = before == members_.end();
      const nanoseconds ahead(sample_->clock_ns - wire_contract::since_1970_ns());
      FleetMember member = decode(*sample_);
      // Of the samples that came while this listened, the one that came quickest says most.
      if (!is_first)
        member.clock_ahead = heard_fresh_[member.server]++ == 0 ? ahead : std::max(before->second.clock_ahead, ahead);
      members_.insert_or_assign(member.server, std::move(member));
    }
  }

  dds::Topic<wire::Member> topic_;
  dds::Reader<wire::Member> reader_;
  dds::WaitSet waitset_;
  dds::Sample<wire::Member> sample_;
  std::map<std::uint64_t, FleetMember> members_;
  std::map<std::uint64_t, int> heard_fresh_;  // samples that came while this listened
};

}  // namespace

Result<Fleet> fleet(const ConnectOptions& options) {
  try {
    const std::shared_ptr<dds::Participant> participant = client::join_domain(options);
    FleetListener listener(*participant, options.name_space);
    Fleet found;
    found.members = listener.listen(Clock::now() + kListen);
    if (found.members.empty()) {
      return Error{ErrorCode::no_server,
                   "no collided heard in " + client::words(kListen) + " on domain " + std::to_string(options.domain) +
                       ", namespace '" + options.name_space + '\'',
                   "start a server with 'collided'; collide doctor looks for the cause"};
    }
    found.findings = fleet_findings(found.members);
    return found;
  } catch (const std::invalid_argument& wrong) {
    return client::bad_input(wrong.what());
  } catch (const dds::KeysError& wrong) {
    return client::bad_input(wrong.what());
  } catch (const dds::DdsError& failed) { return client::failure_of(failed); }
}

}  // namespace collided
