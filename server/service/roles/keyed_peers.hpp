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

/// Who is behind a participant, by the keys that it has shown.
struct KeyedPeer {
  std::string name;                  // of the certificate
  std::vector<std::string> objects;  // globs of the names that it may publish or change; empty: all
  bool asks_high = false;            // may ask questions of high importance
  bool may_name(std::string_view object) const;
};

/// The peers of a server with keys. DDS has checked who they are and which topics they may use before any sample of
/// theirs comes; what is finer than topics is in their permissions, and is kept here.
///
/// threads  any
class KeyedPeers {
 public:
  /// keys       the server's own folder
  /// handshake  the library that dds::ProvenPeers loads
  KeyedPeers(const std::string& keys, const std::string& handshake);

  /// Null where nobody with this prefix has proved who it is.
  std::shared_ptr<const KeyedPeer> of(const dds::GuidPrefix& prefix);
  /// Reads the list of revoked certificates again where its file has changed, and has DDS drop who shows one of them. To
  /// be called now and then, from one thread.
  ///
  /// returns  what there is to say about it; empty: nothing
  std::string look_for_revoked();
  /// The same about participants that are not met, because too many others have proven nothing.
  std::string look_for_turned_away();

 private:
  /// What was read of what a peer has shown.
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
  std::map<dds::GuidPrefix, Read> read_;     // of late: verifying a signature takes as long as a thousand questions
  std::filesystem::file_time_type read_at_;  // the list's time when it was read
  std::int64_t looked_ns_ = 0;
  std::size_t revoked_count_ = 0;  // of the list as it was read
  std::uint64_t turned_away_to_report_ = 1;
};

/// The library beside the program or where it was installed. Throws DdsError where there is none.
std::string handshake_library();

}  // namespace collided::engine::service
