#include "client/keys/authority.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "idl/keys/key_folder.hpp"

namespace collided::keys {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSecrets = "authority";
constexpr const char* kIdentityKey = "identity_key.pem";
constexpr const char* kPermissionsKey = "permissions_key.pem";
constexpr const char* kIssued = "issued.txt";  // a line each: serial number, name, end in seconds since 1970
constexpr std::int64_t kDayS = 86'400;
constexpr std::int64_t kAuthorityDays = 3'650;
constexpr std::int64_t kSoonDays = 30;
constexpr int kMostDays = 3'650;

[[noreturn]] void fail(const std::string& path) { throw KeyError(path + ": " + std::strerror(errno)); }

/// Writes to a temporary file and renames it, so that no reader finds half a file.
void write_file(const std::string& path, const std::string& text, mode_t mode) {
  const std::string beside = path + ".new";
  const int file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, mode);
  if (file < 0) fail(beside);
  // A file of an earlier run may be readable by others.
  bool worked = ::fchmod(file, mode) == 0;
  for (std::size_t done = 0; worked && done < text.size();) {
    const ssize_t wrote = ::write(file, text.data() + done, text.size() - done);
    worked = wrote > 0;
    if (worked) done += static_cast<std::size_t>(wrote);
  }
  worked = worked && ::fsync(file) == 0;
  worked = ::close(file) == 0 && worked;
  if (!worked || ::rename(beside.c_str(), path.c_str()) != 0) fail(path);
}

void make_folder(const std::string& path, mode_t mode) {
  if (::mkdir(path.c_str(), mode) != 0 && errno != EEXIST) fail(path);
}

/// A name becomes part of file names, certificates and XML.
void check_name(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (name.empty() || name.size() > 64 || name.front() == '-' || name == kSecrets ||
      !std::ranges::all_of(name, allowed))
    throw KeyError("'" + name + "' cannot be a name: 1 to 64 letters, digits, '_' and '-', and not '" + kSecrets + "'");
}

/// A glob becomes part of XML and is matched with names of objects.
void check_glob(const std::string& glob) {
  const bool is_text =
      std::ranges::all_of(glob, [](char c) { return static_cast<unsigned char>(c) > ' ' && c != 127; });
  if (glob.empty() || glob.size() > wire_contract::kMaxNameBytes || !is_text)
    throw KeyError("--objects '" + glob + "': 1 to 255 bytes, no blanks");
}

}  // namespace

void Authority::init(const std::string& folder, Protection protection) {
  const std::string secrets = folder + '/' + kSecrets;
  if (fs::exists(secrets)) throw KeyError(secrets + " is there already; keys are made by `collide keys add`");
  make_folder(folder, 0700);
  make_folder(secrets, 0700);
  const std::int64_t until_s = std::time(nullptr) + kAuthorityDays * kDayS;
  const KeyPair identity = make_authority("collided identity authority", until_s);
  const KeyPair permissions = make_authority("collided permissions authority", until_s);
  write_file(secrets + '/' + kIdentityKey, identity.key, 0600);
  write_file(secrets + '/' + kPermissionsKey, permissions.key, 0600);
  write_file(secrets + '/' + kPermissionsAuthority, permissions.certificate, 0644);
  write_file(secrets + '/' + kGovernance, signed_document(permissions, governance_xml(protection)), 0644);
  write_file(secrets + '/' + kRevoked, revoked_list(identity, {}, until_s), 0644);
  write_file(secrets + '/' + kIssued, "", 0600);
  write_file(secrets + '/' + kIdentityAuthority, identity.certificate, 0644);
}

Authority::Authority(const std::string& folder) : folder_(folder), secrets_(folder + '/' + kSecrets) {
  if (!fs::exists(secrets_ + '/' + kIdentityAuthority))
    throw KeyError("'" + folder + "' has no authority; collide keys init " + folder);
  identity_ = {read_key_file(secrets_ + '/' + kIdentityAuthority), read_key_file(secrets_ + '/' + kIdentityKey)};
  permissions_ = {read_key_file(secrets_ + '/' + kPermissionsAuthority),
                  read_key_file(secrets_ + '/' + kPermissionsKey)};
  until_s_ = facts_of(identity_.certificate, secrets_ + '/' + kIdentityAuthority).until_s;
}

std::vector<Authority::Issued> Authority::issued() const {
  std::istringstream lines(read_key_file(secrets_ + '/' + kIssued));
  std::vector<Issued> all;
  for (Issued one; lines >> one.serial >> one.name >> one.until_s;) all.push_back(one);
  return all;
}

std::string Authority::add(const std::string& name, const std::vector<KeyRole>& roles,
                           const std::vector<std::string>& objects, int days) {
  check_name(name);
  if (roles.empty()) throw KeyError("which --role for '" + name + "'?");
  for (const std::string& glob : objects) check_glob(glob);
  if (days < 1 || days > kMostDays) throw KeyError("--days " + std::to_string(days) + ": allowed 1 to 3650");
  const std::int64_t now_s = std::time(nullptr);
  const std::int64_t until_s = std::min(now_s + days * kDayS, until_s_);
  const KeyPair member = make_member(identity_, name, until_s);
  // Recorded first: a certificate that is not on the list could not be revoked.
  std::string list = read_key_file(secrets_ + '/' + kIssued);
  list += facts_of(member.certificate, name).serial + ' ' + name + ' ' + std::to_string(until_s) + '\n';
  write_file(secrets_ + '/' + kIssued, list, 0600);
  const std::string folder = folder_ + '/' + name;
  make_folder(folder, 0700);
  const Grant grant{.name = name, .roles = roles, .objects = objects, .from_s = now_s - 3'600, .until_s = until_s};
  for (const char* shared : {kIdentityAuthority, kPermissionsAuthority, kGovernance, kRevoked})
    write_file(folder + '/' + shared, read_key_file(secrets_ + '/' + shared), 0644);
  write_file(folder + '/' + kPermissions, signed_document(permissions_, permissions_xml(grant)), 0644);
  write_file(folder + '/' + kPrivateKey, member.key, 0600);
  write_file(folder + '/' + kCertificate, member.certificate, 0644);
  return folder;
}

std::set<std::string> Authority::revoked() const {
  const std::string path = secrets_ + '/' + kRevoked;
  return revoked_serials(read_key_file(path), identity_.certificate, path);
}

void Authority::write_revoked(const std::set<std::string>& serials) const {
  const std::string list = revoked_list(identity_, serials, until_s_);
  write_file(secrets_ + '/' + kRevoked, list, 0644);
  for (const std::string& name : names()) write_file(folder_ + '/' + name + '/' + kRevoked, list, 0644);
}

std::size_t Authority::revoke(const std::string& name) {
  check_name(name);
  std::set<std::string> serials = revoked();
  std::size_t count = 0;
  bool is_known = false;
  for (const Issued& one : issued()) {
    if (one.name != name) continue;
    is_known = true;
    if (serials.insert(one.serial).second) ++count;
  }
  if (!is_known) throw KeyError("no keys were made for '" + name + "'; nothing was revoked");
  std::error_code error;
  fs::remove_all(folder_ + '/' + name, error);
  if (error) throw KeyError(folder_ + '/' + name + ": " + error.message());
  write_revoked(serials);
  return count;
}

std::set<std::string> Authority::names() const {
  std::set<std::string> all;
  for (const Issued& one : issued()) {
    if (fs::is_directory(folder_ + '/' + one.name)) all.insert(one.name);
  }
  return all;
}

std::vector<KeyFinding> Authority::check() const {
  std::vector<KeyFinding> findings;
  const auto judge = [&](const std::string& name, std::int64_t until_s) {
    const std::int64_t days = (until_s - std::time(nullptr)) / kDayS;
    findings.push_back({days < kSoonDays ? KeyFinding::Kind::soon : KeyFinding::Kind::good, name,
                        "good until " + date_text(until_s) + ", " + std::to_string(days) + " days"});
  };
  judge(kSecrets, until_s_);
  for (const std::string& name : names()) {
    try {
      const KeyHolder holder = check_keys(folder_ + '/' + name);
      judge(name, holder.until_s);
    } catch (const KeyError& wrong) { findings.push_back({KeyFinding::Kind::wrong, name, wrong.what()}); }
  }
  return findings;
}

}  // namespace collided::keys
