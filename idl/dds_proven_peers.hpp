#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace collided::dds {

/// The part of the GUID that all entities of a participant share.
using GuidPrefix = std::array<std::uint8_t, 12>;

/// The credentials that a participant has proved in its handshake. Its GUID begins as its certificate requires.
struct ProvenPeer {
  std::string certificate;  // PEM
  std::string permissions;  // S/MIME
};

/// The library that wraps Cyclone's authentication plugin in a server with keys. Cyclone trusts a peer's claim that its
/// GUID matches its certificate. This library checks the GUID in the peer's packets, by which the server distinguishes
/// peers. It also caches authenticated peers, and drops those with revoked certificates.
///
/// threads  any
class ProvenPeers {
 public:
  /// Loads the library. Throws DdsError.
  explicit ProvenPeers(const std::string& library);

  /// None if no participant with this prefix has completed the handshake.
  std::optional<ProvenPeer> find(const GuidPrefix& prefix) const;
  /// Refuses certificates of these serial numbers (hexadecimal) from now on, and lets DDS drop participants that have
  /// shown one.
  void revoke(const std::set<std::string>& serials) const;
  /// Number of participants refused, for any of these reasons.
  std::uint64_t refused() const;
  /// Number of participant announcements ignored because too many participants were unproven.
  std::uint64_t turned_away() const;

 private:
  using Find = bool (*)(const GuidPrefix&, ProvenPeer&);
  using Revoke = void (*)(const std::set<std::string>&);
  using Count = std::uint64_t (*)();
  Find find_ = nullptr;
  Revoke revoke_ = nullptr;
  Count refused_ = nullptr;
  Count turned_away_ = nullptr;
};

}  // namespace collided::dds
