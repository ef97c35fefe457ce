#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "client/keys/certificates.hpp"
#include "client/keys/documents.hpp"

namespace collided::keys {

/// What is wrong, or will be soon, with one folder of keys.
struct KeyFinding {
  enum class Kind { good, soon, wrong };
  Kind kind = Kind::good;
  std::string name;
  std::string text;
};

/// Two authorities in one folder: one says who somebody is, the other what he may do. DIR/authority has their keys and
/// stays where it is; DIR/NAME is to be copied to where NAME runs.
///
/// Everything here throws KeyError, which says what was not done. One process at a time.
class Authority {
 public:
  /// Makes both authorities in a new folder, good for ten years.
  static void init(const std::string& folder, Protection protection);
  /// Opens what init() made.
  explicit Authority(const std::string& folder);

  /// Makes DIR/NAME, or renews it: keys made before stay good until they expire or are revoked.
  ///
  /// returns  the folder
  std::string add(const std::string& name, const std::vector<KeyRole>& roles, const std::vector<std::string>& objects,
                  int days);
  /// Puts all certificates of that name onto the list of revoked ones, in every folder, and deletes DIR/NAME.
  ///
  /// returns  how many
  std::size_t revoke(const std::string& name);
  /// Every folder of keys: what is missing, what does not fit, what expires within 30 days.
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
  /// Those who have a folder here.
  std::set<std::string> names() const;

  std::string folder_;
  std::string secrets_;  // the folder of the authorities' own keys
  KeyPair identity_;
  KeyPair permissions_;
  std::int64_t until_s_ = 0;
};

}  // namespace collided::keys
