// Stands before Cyclone's authentication in a participant that plays another's: its GUID begins as the victim's would. What
// it shows in the handshake is its own certificate, as the plugin makes it.
#include <dds/security/dds_security_api_authentication.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "idl/dds_security.hpp"

namespace {

using Beginning = std::array<std::uint8_t, 6>;
using Auth = dds_security_authentication;
using Begin = int (*)(const char*, void**, struct ddsi_domaingv*);
using End = int (*)(void*);

// What the test sets before it makes the participant.
Beginning victim{};
bool lies_in_handshake = false;

Beginning own{};
DDS_Security_GUID_t forged{};
Auth original{};
End end_original = nullptr;

DDS_Security_ValidationResult_t local_identity(Auth* auth, DDS_Security_IdentityHandle* handle,
                                               DDS_Security_GUID_t* adjusted, const DDS_Security_DomainId domain,
                                               const DDS_Security_Qos* qos, const DDS_Security_GUID_t* candidate,
                                               DDS_Security_SecurityException* ex) {
  const auto result = original.validate_local_identity(auth, handle, adjusted, domain, qos, candidate, ex);
  std::copy_n(adjusted->prefix, own.size(), own.begin());
  std::copy(victim.begin(), victim.end(), adjusted->prefix);
  forged = *adjusted;
  return result;
}

/// Who begins is decided by the GUIDs; the plugin would compare with the one that it made.
DDS_Security_ValidationResult_t remote_identity(Auth* auth, DDS_Security_IdentityHandle* remote,
                                                DDS_Security_AuthRequestMessageToken* request,
                                                const DDS_Security_AuthRequestMessageToken* remote_request,
                                                const DDS_Security_IdentityHandle local,
                                                const DDS_Security_IdentityToken* token,
                                                const DDS_Security_GUID_t* guid, DDS_Security_SecurityException* ex) {
  const auto result = original.validate_remote_identity(auth, remote, request, remote_request, local, token, guid, ex);
  if (result != DDS_SECURITY_VALIDATION_PENDING_HANDSHAKE_REQUEST &&
      result != DDS_SECURITY_VALIDATION_PENDING_HANDSHAKE_MESSAGE)
    return result;
  return std::memcmp(&forged, guid, sizeof forged) < 0 ? DDS_SECURITY_VALIDATION_PENDING_HANDSHAKE_REQUEST
                                                       : DDS_SECURITY_VALIDATION_PENDING_HANDSHAKE_MESSAGE;
}

/// What the participant says of itself in the handshake, with the GUID that its certificate would give it.
struct Lie {
  explicit Lie(const DDS_Security_OctetSeq* told) : bytes(told->_buffer, told->_buffer + told->_length), seq(*told) {
    const auto found = std::search(bytes.begin(), bytes.end(), victim.begin(), victim.end());
    if (lies_in_handshake && found != bytes.end()) std::copy(own.begin(), own.end(), found);
    seq._buffer = bytes.data();
  }
  std::vector<unsigned char> bytes;
  DDS_Security_OctetSeq seq;
};

DDS_Security_ValidationResult_t request(Auth* auth, DDS_Security_HandshakeHandle* handshake,
                                        DDS_Security_HandshakeMessageToken* message,
                                        const DDS_Security_IdentityHandle initiator,
                                        const DDS_Security_IdentityHandle replier, const DDS_Security_OctetSeq* told,
                                        DDS_Security_SecurityException* ex) {
  const Lie lie(told);
  return original.begin_handshake_request(auth, handshake, message, initiator, replier, &lie.seq, ex);
}

DDS_Security_ValidationResult_t reply(Auth* auth, DDS_Security_HandshakeHandle* handshake,
                                      DDS_Security_HandshakeMessageToken* out,
                                      const DDS_Security_HandshakeMessageToken* in,
                                      const DDS_Security_IdentityHandle initiator,
                                      const DDS_Security_IdentityHandle replier, const DDS_Security_OctetSeq* told,
                                      DDS_Security_SecurityException* ex) {
  const Lie lie(told);
  return original.begin_handshake_reply(auth, handshake, out, in, initiator, replier, &lie.seq, ex);
}

}  // namespace

extern "C" {

void collided_forge(const std::uint8_t* beginning, bool lies) {
  std::copy_n(beginning, victim.size(), victim.begin());
  lies_in_handshake = lies;
}

int collided_handshake_begin(const char* argument, void** made, struct ddsi_domaingv* gv) {
  void* const library = dlopen(collided::dds::authentication_library().c_str(), RTLD_NOW);
  if (library == nullptr) return 1;
  const auto begin = reinterpret_cast<Begin>(dlsym(library, "init_authentication"));
  end_original = reinterpret_cast<End>(dlsym(library, "finalize_authentication"));
  const int result = begin(argument, made, gv);
  if (result != 0) return result;
  auto* const auth = static_cast<Auth*>(*made);
  original = *auth;
  auth->validate_local_identity = local_identity;
  auth->validate_remote_identity = remote_identity;
  auth->begin_handshake_request = request;
  auth->begin_handshake_reply = reply;
  return 0;
}

int collided_handshake_end(void* auth) { return end_original(auth); }
}
