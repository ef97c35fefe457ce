// A library of its own, loaded by Cyclone and by ProvenPeers, which says what for: Cyclone knows its plugins by the names
// of files.
#include <dds/dds.h>
#include <dds/security/dds_security_api_authentication.h>
#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

#include "idl/dds_proven_peers.hpp"
#include "idl/dds_security.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::dds {
namespace {

using Plugin = dds_security_authentication;
using BeginPlugin = int (*)(const char*, void**, struct ddsi_domaingv*);
using EndPlugin = int (*)(void*);

/// A participant that is being met, by the handle of its identity.
struct Remote {
  Plugin* plugin = nullptr;
  GuidPrefix prefix{};
  bool is_proven = false;
  ProvenPeer proven = {};
  std::string serial = {};
};

/// One for the process: a server has one participant.
struct MetPeers {
  std::mutex mutex;
  std::map<DDS_Security_IdentityHandle, Remote> remotes;
  std::map<DDS_Security_HandshakeHandle, DDS_Security_IdentityHandle> remote_of_handshake;
  std::set<std::string> revoked;
  std::uint64_t refused = 0;
  Plugin original{};  // the same functions for every instance
  EndPlugin end_original = nullptr;
  const dds_security_authentication_listener* listener = nullptr;
};
MetPeers& meetings() {
  static MetPeers& only = *new MetPeers;  // never destroyed: DDS's threads may outlive static objects
  return only;
}

DDS_Security_ValidationResult_t validate_remote_identity(
    Plugin* plugin, DDS_Security_IdentityHandle* remote, DDS_Security_AuthRequestMessageToken* request,
    const DDS_Security_AuthRequestMessageToken* remote_request, const DDS_Security_IdentityHandle local,
    const DDS_Security_IdentityToken* token, const DDS_Security_GUID_t* guid, DDS_Security_SecurityException* ex) {
  MetPeers& all = meetings();
  const auto result =
      all.original.validate_remote_identity(plugin, remote, request, remote_request, local, token, guid, ex);
  if (result == DDS_SECURITY_VALIDATION_FAILED) return result;
  const std::lock_guard lock(all.mutex);
  Remote& met = all.remotes[*remote];
  met.plugin = plugin;
  std::copy_n(guid->prefix, met.prefix.size(), met.prefix.begin());
  return result;
}

void note_handshake(DDS_Security_HandshakeHandle handshake, DDS_Security_IdentityHandle remote) {
  const std::lock_guard lock(meetings().mutex);
  meetings().remote_of_handshake[handshake] = remote;
}

DDS_Security_ValidationResult_t begin_request(Plugin* plugin, DDS_Security_HandshakeHandle* handshake,
                                              DDS_Security_HandshakeMessageToken* message,
                                              const DDS_Security_IdentityHandle initiator,
                                              const DDS_Security_IdentityHandle replier,
                                              const DDS_Security_OctetSeq* told, DDS_Security_SecurityException* ex) {
  const auto result =
      meetings().original.begin_handshake_request(plugin, handshake, message, initiator, replier, told, ex);
  if (result != DDS_SECURITY_VALIDATION_FAILED) note_handshake(*handshake, replier);
  return result;
}

DDS_Security_ValidationResult_t begin_reply(Plugin* plugin, DDS_Security_HandshakeHandle* handshake,
                                            DDS_Security_HandshakeMessageToken* out,
                                            const DDS_Security_HandshakeMessageToken* in,
                                            const DDS_Security_IdentityHandle initiator,
                                            const DDS_Security_IdentityHandle replier,
                                            const DDS_Security_OctetSeq* told, DDS_Security_SecurityException* ex) {
  const auto result =
      meetings().original.begin_handshake_reply(plugin, handshake, out, in, initiator, replier, told, ex);
  if (result != DDS_SECURITY_VALIDATION_FAILED) note_handshake(*handshake, initiator);
  return result;
}

std::string property(const DDS_Security_AuthenticatedPeerCredentialToken& token, std::string_view name) {
  for (std::uint32_t i = 0; i < token.properties._length; ++i) {
    const DDS_Security_Property_t& one = token.properties._buffer[i];
    if (one.name != nullptr && one.value != nullptr && one.name == name) return one.value;
  }
  return {};
}

/// Why this peer is not to be met; empty where it is, and then it is remembered.
std::string judge(MetPeers& all, DDS_Security_HandshakeHandle handshake, const ProvenPeer& shown) {
  const std::lock_guard lock(all.mutex);
  const auto named = all.remote_of_handshake.find(handshake);
  const auto found = named == all.remote_of_handshake.end() ? all.remotes.end() : all.remotes.find(named->second);
  std::string refusal;
  if (found == all.remotes.end()) {
    refusal = "a handshake with nobody";
  } else {
    try {
      const keys::CertificateFacts facts = keys::facts_of(shown.certificate, "certificate of a peer");
      if (!std::equal(facts.guid_beginning.begin(), facts.guid_beginning.end(), found->second.prefix.begin()))
        refusal = '\'' + facts.common_name + "' uses a GUID that its certificate does not give it";
      else if (all.revoked.contains(facts.serial))
        refusal = '\'' + facts.common_name + "' shows a certificate that is revoked";
      found->second.proven = shown;
      found->second.serial = facts.serial;
    } catch (const keys::KeyError& wrong) { refusal = wrong.what(); }
    found->second.is_proven = refusal.empty();
  }
  if (!refusal.empty()) ++all.refused;
  return refusal;
}

/// Called once the peer has proved that the certificate is its own, before anything is allowed to it.
DDS_Security_boolean peer_credential(Plugin* plugin, DDS_Security_AuthenticatedPeerCredentialToken* token,
                                     const DDS_Security_HandshakeHandle handshake, DDS_Security_SecurityException* ex) {
  MetPeers& all = meetings();
  if (!all.original.get_authenticated_peer_credential_token(plugin, token, handshake, ex)) return false;
  const std::string refusal =
      judge(all, handshake, {.certificate = property(*token, "c.id"), .permissions = property(*token, "c.perm")});
  if (refusal.empty()) return true;
  all.original.return_authenticated_peer_credential_token(plugin, token, ex);
  std::memset(token, 0, sizeof *token);
  ex->code = 1;
  ex->message = dds_string_dup(refusal.c_str());
  return false;
}

DDS_Security_boolean set_listener(Plugin* plugin, const dds_security_authentication_listener* listener,
                                  DDS_Security_SecurityException* ex) {
  {
    const std::lock_guard lock(meetings().mutex);
    meetings().listener = listener;
  }
  return meetings().original.set_listener(plugin, listener, ex);
}

DDS_Security_boolean return_identity(Plugin* plugin, const DDS_Security_IdentityHandle identity,
                                     DDS_Security_SecurityException* ex) {
  {
    const std::lock_guard lock(meetings().mutex);
    meetings().remotes.erase(identity);
  }
  return meetings().original.return_identity_handle(plugin, identity, ex);
}

DDS_Security_boolean return_handshake(Plugin* plugin, const DDS_Security_HandshakeHandle handshake,
                                      DDS_Security_SecurityException* ex) {
  {
    const std::lock_guard lock(meetings().mutex);
    meetings().remote_of_handshake.erase(handshake);
  }
  return meetings().original.return_handshake_handle(plugin, handshake, ex);
}

}  // namespace
}  // namespace collided::dds

#pragma GCC visibility push(default)
extern "C" {

using collided::dds::meetings;

int collided_handshake_begin(const char* argument, void** made, struct ddsi_domaingv* gv) {
  using namespace collided::dds;
  void* const library = dlopen(authentication_library().c_str(), RTLD_NOW);
  if (library == nullptr) return 1;
  const auto begin = reinterpret_cast<BeginPlugin>(dlsym(library, "init_authentication"));
  const auto end = reinterpret_cast<EndPlugin>(dlsym(library, "finalize_authentication"));
  if (begin == nullptr || end == nullptr || begin(argument, made, gv) != 0) return 1;
  auto* const plugin = static_cast<Plugin*>(*made);
  {
    const std::lock_guard lock(meetings().mutex);
    meetings().original = *plugin;
    meetings().end_original = end;
  }
  plugin->validate_remote_identity = validate_remote_identity;
  plugin->begin_handshake_request = begin_request;
  plugin->begin_handshake_reply = begin_reply;
  plugin->get_authenticated_peer_credential_token = peer_credential;
  plugin->set_listener = set_listener;
  plugin->return_identity_handle = return_identity;
  plugin->return_handshake_handle = return_handshake;
  return 0;
}

int collided_handshake_end(void* plugin) {
  {
    const std::lock_guard lock(meetings().mutex);
    std::erase_if(meetings().remotes, [&](const auto& one) { return one.second.plugin == plugin; });
    meetings().listener = nullptr;
  }
  return meetings().end_original(plugin);
}

bool collided_handshake_find(const collided::dds::GuidPrefix& prefix, collided::dds::ProvenPeer& peer) {
  const std::lock_guard lock(meetings().mutex);
  for (const auto& [handle, remote] : meetings().remotes) {
    if (!remote.is_proven || remote.prefix != prefix) continue;
    peer = remote.proven;
    return true;
  }
  return false;
}

void collided_handshake_revoke(const std::set<std::string>& serials) {
  using namespace collided::dds;
  std::vector<std::pair<Plugin*, DDS_Security_IdentityHandle>> gone;
  const dds_security_authentication_listener* listener = nullptr;
  {
    const std::lock_guard lock(meetings().mutex);
    meetings().revoked = serials;
    listener = meetings().listener;
    for (auto& [handle, remote] : meetings().remotes) {
      if (!remote.is_proven || !serials.contains(remote.serial)) continue;
      remote.is_proven = false;
      gone.emplace_back(remote.plugin, handle);
    }
  }
  // Outside of the lock: DDS gives the handles back meanwhile.
  if (listener == nullptr || listener->on_revoke_identity == nullptr) return;
  for (const auto& [plugin, handle] : gone) listener->on_revoke_identity(plugin, handle);
}

std::uint64_t collided_handshake_refused() {
  const std::lock_guard lock(meetings().mutex);
  return meetings().refused;
}
}
#pragma GCC visibility pop
