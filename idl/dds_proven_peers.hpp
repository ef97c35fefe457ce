#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace collided::dds {

/// What all entities of a participant have in common in their GUIDs.
using GuidPrefix = std::array<std::uint8_t, 12>;

/// What a participant has proved in its handshake, and that its GUID begins as its certificate demands.
struct ProvenPeer {
  std::string certificate;  // PEM
  std::string permissions;  // S/MIME
};

/// The library that stands before Cyclone's own for authentication in a server with keys. Cyclone takes it from a peer's
/// own word that its GUID fits its certificate; this compares the GUID that the peer's packets come from, since by that
/// the server tells peers apart. It also remembers who has proved what, and forgets those whose certificate is revoked.
///
/// threads  any
class ProvenPeers {
 public:
  /// Loads the library. Throws DdsError.
  explicit ProvenPeers(const std::string& library);

  /// None where no participant with this prefix has come through the handshake.
  std::optional<ProvenPeer> find(const GuidPrefix& prefix) const;
  /// Refuses certificates of these serial numbers (hexadecimal) from now on, and has DDS drop the participants that
  /// have shown one.
  void revoke(const std::set<std::string>& serials) const;
  /// How many participants were refused, for whatever reason above.
  std::uint64_t refused() const;
  /// How many announcements of participants were ignored, because too many others had not proven anything yet.
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
