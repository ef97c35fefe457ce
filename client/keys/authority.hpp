#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "client/keys/certificates.hpp"
#include "client/keys/documents.hpp"

namespace collided::keys {

/// A present or upcoming fault of one folder of keys.
struct KeyFinding {
  enum class Kind { good, soon, wrong };
  Kind kind = Kind::good;
  std::string name;
  std::string text;
};

/// Two authorities in one folder: one certifies identities, the other permissions. DIR/authority has their keys and
/// stays in place; DIR/NAME must be copied to the machine that runs NAME.
///
/// Everything here throws KeyError, which names the step that was not done. One process at a time.
class Authority {
 public:
  /// Makes both authorities in a new folder, valid for ten years.
  static void init(const std::string& folder, Protection protection);
  /// Opens the folder made by init().
  explicit Authority(const std::string& folder);

  /// Makes DIR/NAME, or renews it: earlier keys stay valid until they expire or are revoked.
  ///
  /// returns  the folder
  std::string add(const std::string& name, const std::vector<KeyRole>& roles, const std::vector<std::string>& objects,
                  int days);
  /// Puts all certificates of that name onto the list of revoked ones, in every folder, and deletes DIR/NAME.
  ///
  /// returns  their number
  std::size_t revoke(const std::string& name);
  /// Checks every folder of keys: what is missing, does not match, or expires within 30 days.
  std::vector<KeyFinding> check() const;

 private:
  struct Issued {
    std::string serial;
    std::string name;
    std::int64_t until_s = 0;
  };
  std::vector<Issued> issued() const;
  std::set<std::string> revoked() const;
  void write_revoked(const std::set<std::string>& serials) const;
  /// The names with a folder here.
  std::set<std::string> names() const;

  std::string folder_;
  std::string secrets_;  // the folder of the authorities' own keys
  KeyPair identity_;
  KeyPair permissions_;
  std::int64_t until_s_ = 0;
};

}  // namespace collided::keys
