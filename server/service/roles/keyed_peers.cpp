#include "server/service/roles/keyed_peers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <utility>

#include "idl/dds.hpp"
#include "idl/glob.hpp"
#include "idl/keys/key_folder.hpp"
#include "server/intake/helper_program.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

/// Calls with the name and value of every data tag in the allow rules of the permissions.
template <class Tag>
void for_each_tag(const pugi::xml_document& permissions, Tag&& tag) {
  for (const pugi::xpath_node& found :
       permissions.select_nodes("/dds/permissions/grant/allow_rule/publish/data_tags/tag"))
    tag(std::string_view(found.node().child_value("name")), std::string_view(found.node().child_value("value")));
}

}  // namespace

bool KeyedPeer::may_name(std::string_view object) const {
  return objects.empty() || std::ranges::any_of(objects, [&](const std::string& glob) {
           return wire_contract::glob_matches(glob, object);
         });
}

std::string handshake_library() {
  const HelperProgram found = find_helper_program("collided-handshake.so", "COLLIDED_HANDSHAKE");
  if (found.path.empty()) throw dds::DdsError("keys need " + found.why_not);
  return found.path;
}

KeyedPeers::KeyedPeers(const std::string& keys, const std::string& handshake)
    : keys_(keys),
      permissions_authority_(keys::read_key_file(keys + '/' + keys::kPermissionsAuthority)),
      identity_authority_(keys::read_key_file(keys + '/' + keys::kIdentityAuthority)),
      proven_(handshake) {}

std::shared_ptr<const KeyedPeer> KeyedPeers::of(const dds::GuidPrefix& prefix) {
  constexpr std::size_t kMost = 1'024;
  std::optional<dds::ProvenPeer> shown = proven_.find(prefix);
  if (!shown) return nullptr;
  const std::lock_guard lock(mutex_);
  if (read_.size() >= kMost) read_.clear();
  Read& known = read_[prefix];
  if (!known.peer || known.shown.certificate != shown->certificate || known.shown.permissions != shown->permissions)
    known = {.shown = *shown, .peer = read(*shown)};
  return known.peer;
}

/// DDS has verified the permissions; read again here, only from the signed part, so that unsigned text is ignored.
std::shared_ptr<const KeyedPeer> KeyedPeers::read(const dds::ProvenPeer& peer) const {
  const std::string text = keys::signed_text(peer.permissions, permissions_authority_);
  pugi::xml_document permissions;
  if (text.empty() || !permissions.load_buffer(text.data(), text.size())) return nullptr;
  auto keyed = std::make_shared<KeyedPeer>();
  try {
    keyed->name = keys::facts_of(peer.certificate, "certificate of a peer").common_name;
  } catch (const keys::KeyError&) { return nullptr; }
  for_each_tag(permissions, [&](std::string_view name, std::string_view value) {
    if (name == keys::kObjectsTag) keyed->objects.emplace_back(value);
    if (name == keys::kImportanceTag && value == "high") keyed->asks_high = true;
  });
  return keyed;
}

std::string KeyedPeers::look_for_revoked() {
  constexpr std::int64_t kPeriodNs = 1'000'000'000;
  const std::int64_t now_ns = steady_ns();
  if (looked_ns_ != 0 && now_ns - looked_ns_ < kPeriodNs) return {};
  looked_ns_ = now_ns;
  const std::string path = keys_ + '/' + keys::kRevoked;
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (error || written == read_at_) return {};
  read_at_ = written;
  try {
    const auto serials = keys::revoked_serials(keys::read_key_file(path), identity_authority_, path);
    proven_.revoke(serials);
    if (std::exchange(revoked_count_, serials.size()) == serials.size()) return {};
    return fmt::format("{} certificates are revoked", serials.size());
  } catch (const keys::KeyError& wrong) {
    return fmt::format("{}; who was revoked before stays so, nobody else is", wrong.what());
  }
}

std::string KeyedPeers::look_for_turned_away() {
  const std::uint64_t count = proven_.turned_away();
  if (count < turned_away_to_report_) return {};
  turned_away_to_report_ = 2 * count;
  return fmt::format(
      "programs without keys of this authority announce participants faster than they can be met; new clients wait. "
      "Announcements ignored so far: {}",
      count);
}

}  // namespace collided::engine::service
