#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "idl/dds.hpp"
#include "server/service/events/dds_event_writer.hpp"
#include "server/fleet/instant_digest.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// A member that has said nothing for so long is gone.
inline constexpr std::int64_t kMemberGoneNs = 4 * wire_contract::kMemberPeriodNs;

/// What a server is called: as its options say, else by the machine's name and the process number.
std::string member_name(const std::string& given);

/// What a standby wants of its primary; all numbers grow. A primary reports whose place it has taken.
struct Following {
  std::uint64_t primary = 0;  // 0: none is followed
  std::uint64_t fetch = 0;  // of all that is kept; of a primary: how many of that one's changes it carried out, plus 1
  std::uint64_t again = 0;  // that publishers define everything again
};

/// What another server of the namespace says of itself.
struct OtherMember {
  std::uint64_t server = 0;
  std::uint64_t epoch = 0;
  wire_contract::MemberRole role = wire_contract::MemberRole::primary;
  wire_contract::ServerState state = wire_contract::ServerState::starting;
  std::string name;
  std::string host;
  std::string version;
  std::uint64_t scene_fingerprint = 0;
  InstantDigest digest;
  Following following;
  std::int64_t heard_ns = 0;                // its newest message, steady clock
  std::deque<std::int64_t> clock_ahead_ns;  // of this machine's clock, when the newest samples came
};

/// What this server says of itself, beside what the Membership finds out.
struct SelfDescription {
  std::function<wire_contract::MemberRole()> role;
  std::function<std::uint64_t()> epoch;
  std::string name;
  std::function<wire_contract::ServerState()> state;
  std::function<std::string()> alarm;             // what is wrong with this server, one sentence a line; empty: nothing
  std::function<std::int64_t()> settled_ns;       // see DigestMaker::make
  std::function<Following()> following;           // of a primary: whose place it has taken, or nobody's
  std::function<void(const OtherMember&)> heard;  // called with each message of another one
  std::function<void(std::uint64_t)> gone;        // called with the number of another one that has left, or is lost
  std::function<void(const DigestMaker&)> digested;  // called with each new digest of the own world
};

/// This server among those of its namespace: says twice a second what it is, hears the others, and reports what does not
/// fit together. The world is compared only while there is somebody to compare it with.
///
/// threads  one of its own, on which it calls what it was given; the calls here are for any
class Membership {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// world and clock must outlive this.
  Membership(const dds::Participant& participant, const Identity& identity, SelfDescription self, const World& world,
             const WorldClock& clock, Notice notice);
  ~Membership();
  Membership(const Membership&) = delete;
  Membership& operator=(const Membership&) = delete;

  /// Has the others told at once what has changed about this server.
  void say_now();
  /// To be called last: the others learn that this one has left rather than fallen silent.
  void leave();

 private:
  void run();
  void take();
  void hear(const dds::Sample<wire::Member>& sample);
  using Faults = std::map<std::pair<std::string, std::uint64_t>, std::string>;
  Faults faults() const;
  void report(const Faults& found);
  void write();

  const SelfDescription self_;
  const World& world_;
  const WorldClock& clock_;
  const Notice notice_;
  const Identity identity_;
  dds::Topic<wire::Member> topic_;
  dds::Writer<wire::Member> writer_;
  dds::Reader<wire::Member> reader_;
  dds::WaitSet waitset_;
  dds::Sample<wire::Member> said_;                              // of the thread
  dds::Sample<wire::Member> heard_;                             // likewise
  std::map<std::uint64_t, OtherMember> others_;                 // likewise
  DigestMaker digests_;                                         // likewise
  std::map<std::pair<std::string, std::uint64_t>, int> looks_;  // in how many in a row a fault was found
  std::atomic<bool> says_now_{false};
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace collided::engine::service
