#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/etcd_members.hpp"
#include "idl/etcd/lease_store.hpp"

namespace collided::etcd {

/// The keys and leases of etcd; each member has patience_ns for an answer.
///
/// threads  one
class EtcdClient : public LeaseStore {
 public:
  /// Throws ModuleMissing.
  EtcdClient(EtcdAddress address, std::int64_t patience_ns);

  std::int64_t grant(int life_s) override;
  bool renew(std::int64_t lease) override;
  void revoke(std::int64_t lease) override;
  StoreResult transact(const StoreTransaction& transaction) override;

 private:
  /// Returns read(answer) for the first good answer.
  template <class Read>
  auto call(const char* target, const nlohmann::json& question, Read&& read);

  EtcdMembers members_;
};

}  // namespace collided::etcd
