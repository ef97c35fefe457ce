#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dds_proven_peers.hpp"

namespace collided::engine::service {

/// The identity of a participant, by the keys that it has shown.
struct KeyedPeer {
  std::string name;                  // of the certificate
  std::vector<std::string> objects;  // globs of the names that it may publish or change; empty: all
  bool asks_high = false;            // may ask questions of high importance
  bool may_name(std::string_view object) const;
};

/// The peers of a server with keys. DDS has checked their identity and topics before any of their samples arrives;
/// finer rights are in their permissions, and are kept here.
///
/// threads  any
class KeyedPeers {
 public:
  /// keys       the server's own folder
  /// handshake  the library that dds::ProvenPeers loads
  KeyedPeers(const std::string& keys, const std::string& handshake);

  /// Null if no peer with this prefix has proved its identity.
  std::shared_ptr<const KeyedPeer> of(const dds::GuidPrefix& prefix);
  /// Reads the list of revoked certificates again if its file has changed, and has DDS drop peers that show one of
  /// them. Call this regularly, from one thread.
  ///
  /// returns  a text for the log; empty: nothing changed
  std::string look_for_revoked();
  /// The same about participants that are turned away because too many others have proved nothing.
  std::string look_for_turned_away();

 private:
  /// The data read from a peer's documents.
  struct Read {
    dds::ProvenPeer shown;
    std::shared_ptr<const KeyedPeer> peer;
  };
  std::shared_ptr<const KeyedPeer> read(const dds::ProvenPeer& peer) const;

  const std::string keys_;
  const std::string permissions_authority_;  // PEM
  const std::string identity_authority_;     // PEM
  dds::ProvenPeers proven_;
  std::mutex mutex_;
  std::map<dds::GuidPrefix, Read> read_;     // recent ones: verifying a signature takes as long as a thousand questions
  std::filesystem::file_time_type read_at_;  // the list's time when it was read
  std::int64_t looked_ns_ = 0;
  std::size_t revoked_count_ = 0;  // of the list that was read
  std::uint64_t turned_away_to_report_ = 1;
};

/// The library next to the program or at its installed place. Throws DdsError if there is none.
std::string handshake_library();

}  // namespace collided::engine::service
