#include "idl/dds_proven_peers.hpp"

#include <dlfcn.h>

#include "idl/dds.hpp"

namespace collided::dds {
namespace {

template <class Function>
Function symbol(void* library, const char* name) {
  const auto found = reinterpret_cast<Function>(dlsym(library, name));
  if (found == nullptr) throw DdsError(std::string("handshake library: no ") + name);
  return found;
}

}  // namespace

ProvenPeers::ProvenPeers(const std::string& library) {
  // Never closed: DDS's threads may run in it until the process ends.
  void* const loaded = dlopen(library.c_str(), RTLD_NOW);
  if (loaded == nullptr) {
    const char* const why = dlerror();
    throw DdsError(why == nullptr ? library : why);
  }
  find_ = symbol<Find>(loaded, "collided_handshake_find");
  revoke_ = symbol<Revoke>(loaded, "collided_handshake_revoke");
  refused_ = symbol<Count>(loaded, "collided_handshake_refused");
  turned_away_ = symbol<Count>(loaded, "collided_handshake_turned_away");
}

std::optional<ProvenPeer> ProvenPeers::find(const GuidPrefix& prefix) const {
  ProvenPeer peer;
  if (!find_(prefix, peer)) return std::nullopt;
  return peer;
}

void ProvenPeers::revoke(const std::set<std::string>& serials) const { revoke_(serials); }

std::uint64_t ProvenPeers::refused() const { return refused_(); }

std::uint64_t ProvenPeers::turned_away() const { return turned_away_(); }

}  // namespace collided::dds
