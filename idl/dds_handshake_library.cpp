// Wraps Cyclone's authentication plugin in every program with keys. Cyclone loads its plugins from files: a server
// loads this as collided-handshake.so; the client library contains it and loads itself. ProvenPeers documents its use
// in a server. In any program it prevents strangers from crashing or blocking it (dds_builtin_guard.h).
#include <dds/dds.h>
#include <dds/security/dds_security_api_authentication.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <string_view>
#include <vector>

#include "idl/dds_builtin_guard.h"
#include "idl/dds_proven_peers.hpp"
#include "idl/dds_security.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::dds {
namespace {

using Plugin = dds_security_authentication;
using BeginPlugin = int (*)(const char*, void**, struct ddsi_domaingv*);
using EndPlugin = int (*)(void*);

/// A participant during its handshake, by the handle of its identity.
struct Remote {
  Plugin* plugin = nullptr;
  GuidPrefix prefix{};
  bool is_proven = false;
  ProvenPeer proven = {};
  std::string serial = {};
};

using std::chrono::steady_clock;

/// Each unproven participant costs a handshake, and a forger can invent any number of GUIDs. Therefore only few are
/// admitted at a time. A participant whose identity is not proven within kTimeToProve makes room for the next, but
/// not earlier: otherwise the handshakes of many programs that start together would evict each other forever.
constexpr std::size_t kMostUnproven = 256;
constexpr std::chrono::seconds kTimeToProve{10};

/// The participants of a domain.
struct Domain {
  struct ddsi_domaingv* cyclone = nullptr;
  std::array<std::uint8_t, 16> own_guid{};
  bool has_participant = false;
  std::map<GuidPrefix, steady_clock::time_point> unproven;  // since when
  std::set<GuidPrefix> proven;
};

/// One per process.
struct MetPeers {
  std::mutex mutex;
  std::map<Plugin*, Domain> domains;
  std::map<DDS_Security_IdentityHandle, Remote> remotes;
  std::map<DDS_Security_HandshakeHandle, DDS_Security_IdentityHandle> remote_of_handshake;
  std::set<std::string> revoked;
  std::uint64_t refused = 0;
  std::uint64_t turned_away = 0;
  Plugin original{};  // the same functions for every instance
  EndPlugin end_original = nullptr;
  const dds_security_authentication_listener* listener = nullptr;
};
MetPeers& meetings() {
  static MetPeers& only = *new MetPeers;  // never destroyed: DDS's threads may outlive static objects
  return only;
}

DDS_Security_ValidationResult_t validate_local_identity(Plugin* plugin, DDS_Security_IdentityHandle* local,
                                                        DDS_Security_GUID_t* adjusted,
                                                        const DDS_Security_DomainId domain_id,
                                                        const DDS_Security_Qos* qos,
                                                        const DDS_Security_GUID_t* candidate,
                                                        DDS_Security_SecurityException* ex) {
  MetPeers& all = meetings();
  const auto result = all.original.validate_local_identity(plugin, local, adjusted, domain_id, qos, candidate, ex);
  if (result != DDS_SECURITY_VALIDATION_OK) return result;
  const std::lock_guard lock(all.mutex);
  Domain& domain = all.domains[plugin];
  static_assert(sizeof *adjusted == sizeof domain.own_guid);
  std::memcpy(domain.own_guid.data(), adjusted, sizeof domain.own_guid);
  domain.has_participant = true;
  return result;
}

/// Decides whether to admit a participant that has announced itself (dds_builtin_guard.h). A proven one no longer
/// counts towards the limit.
bool judge_participant(struct ddsi_domaingv* cyclone, const std::uint8_t* beginning, std::uint8_t* own_guid) {
  MetPeers& all = meetings();
  GuidPrefix prefix;
  std::copy_n(beginning, prefix.size(), prefix.begin());
  std::optional<GuidPrefix> dropped;
  {
    const std::lock_guard lock(all.mutex);
    const auto found =
        std::ranges::find_if(all.domains, [&](const auto& one) { return one.second.cyclone == cyclone; });
    if (found == all.domains.end() || !found->second.has_participant) return true;
    Domain& domain = found->second;
    if (domain.proven.contains(prefix) || domain.unproven.contains(prefix)) return true;
    const auto now = steady_clock::now();
    if (domain.unproven.size() >= kMostUnproven) {
      const auto oldest = std::ranges::min_element(domain.unproven, {}, [](const auto& one) { return one.second; });
      if (now - oldest->second < kTimeToProve) {
        ++all.turned_away;
        std::ranges::copy(domain.own_guid, own_guid);
        return false;
      }
      dropped = oldest->first;
      domain.unproven.erase(oldest);
    }
    domain.unproven.emplace(prefix, now);
  }
  // Outside of the lock, since Cyclone releases its handles meanwhile.
  if (dropped) collided_drop_participant(cyclone, dropped->data());
  return true;
}

DDS_Security_ValidationResult_t validate_remote_identity(
    Plugin* plugin, DDS_Security_IdentityHandle* remote, DDS_Security_AuthRequestMessageToken* request,
    const DDS_Security_AuthRequestMessageToken* remote_request, const DDS_Security_IdentityHandle local,
    const DDS_Security_IdentityToken* token, const DDS_Security_GUID_t* guid, DDS_Security_SecurityException* ex) {
  MetPeers& all = meetings();
  const auto result =
      all.original.validate_remote_identity(plugin, remote, request, remote_request, local, token, guid, ex);
  // Cyclone reads the length of this text a second later, even if the handshake has been rejected.
  if (request->class_id == nullptr) request->class_id = dds_string_dup("");
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

/// Returns why this peer is refused; empty: it is accepted, and remembered.
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
    if (found->second.is_proven) {
      Domain& domain = all.domains[found->second.plugin];
      domain.unproven.erase(found->second.prefix);
      domain.proven.insert(found->second.prefix);
    }
  }
  if (!refusal.empty()) ++all.refused;
  return refusal;
}

/// Called after the peer has proved that it owns the certificate, and before it gets any permission.
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
    const auto found = meetings().remotes.find(identity);
    if (found != meetings().remotes.end()) {
      meetings().domains[plugin].proven.erase(found->second.prefix);
      meetings().remotes.erase(found);
    }
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

/// Cyclone unloads its plugins before the domain whose packets our functions read.
bool stay_loaded() {
  Dl_info self{};
  return dladdr(reinterpret_cast<const void*>(&stay_loaded), &self) != 0 &&
         dlopen(self.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE) != nullptr;
}

}  // namespace
}  // namespace collided::dds

#pragma GCC visibility push(default)
extern "C" {

using collided::dds::meetings;

int collided_handshake_begin(const char* argument, void** made, struct ddsi_domaingv* gv) {
  using namespace collided::dds;
  void* const library = dlopen(authentication_library().c_str(), RTLD_NOW);
  if (library == nullptr || !stay_loaded()) return 1;
  const auto begin = reinterpret_cast<BeginPlugin>(dlsym(library, "init_authentication"));
  const auto end = reinterpret_cast<EndPlugin>(dlsym(library, "finalize_authentication"));
  if (begin == nullptr || end == nullptr || begin(argument, made, gv) != 0) return 1;
  auto* const plugin = static_cast<Plugin*>(*made);
  {
    const std::lock_guard lock(meetings().mutex);
    if (!collided_guard_domain(gv, judge_participant)) {
      end(plugin);
      return 1;
    }
    meetings().domains[plugin].cyclone = gv;
    meetings().original = *plugin;
    meetings().end_original = end;
  }
  plugin->validate_local_identity = validate_local_identity;
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
    std::erase_if(meetings().domains, [&](const auto& one) { return one.first == plugin; });
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
  // Outside of the lock, since DDS releases the handles meanwhile.
  if (listener == nullptr || listener->on_revoke_identity == nullptr) return;
  for (const auto& [plugin, handle] : gone) listener->on_revoke_identity(plugin, handle);
}

std::uint64_t collided_handshake_refused() {
  const std::lock_guard lock(meetings().mutex);
  return meetings().refused;
}

std::uint64_t collided_handshake_turned_away() {
  const std::lock_guard lock(meetings().mutex);
  return meetings().turned_away;
}
}
#pragma GCC visibility pop
