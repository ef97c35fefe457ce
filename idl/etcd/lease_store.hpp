#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace collided::etcd {

/// The store did not answer in time, or not as it should: one sentence. The request may have been executed nevertheless.
struct StoreError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The store does not serve this client, and will not at the next try: a certificate, a password or a permission. One
/// sentence. Nothing was done.
struct StoreRefused : StoreError {
  using StoreError::StoreError;
};

/// A condition of a transaction on a key. `less` compares bytes. A missing key is neither equal nor less, and has no
/// revision.
struct StoreCondition {
  enum class Is : std::uint8_t { absent, equal, less, revision };
  std::string key;
  Is is = Is::absent;
  std::string value = {};
  std::int64_t revision = 0;  // of the newest write to it
};

struct StoreWrite {
  std::string key;
  std::string value;
  std::int64_t lease = 0;  // the key goes with it; 0: it stays
};

/// Where all conditions hold the writes are done; the keys are read then, in either case.
struct StoreTransaction {
  std::vector<StoreCondition> conditions;
  std::vector<StoreWrite> writes;
  std::vector<std::string> reads;
};

struct StoreResult {
  bool is_done = false;
  std::vector<std::optional<std::string>> values = {};  // of the keys read, in their order; nothing: not there
  std::vector<std::int64_t> revisions = {};             // as many: of the newest write to each; 0: not there
};

/// A store of keys with one order of all operations, and with leases: their keys are removed unless the holder renews the
/// lease. Each call may throw StoreError.
class LeaseStore {
 public:
  virtual ~LeaseStore() = default;
  /// Grants a lease of life_s seconds.
  virtual std::int64_t grant(int life_s) = 0;
  /// Has the lease last its whole life again; false: it is gone.
  virtual bool renew(std::int64_t lease) = 0;
  /// Ends the lease, and its keys.
  virtual void revoke(std::int64_t lease) = 0;
  virtual StoreResult transact(const StoreTransaction& transaction) = 0;
};

}  // namespace collided::etcd
