#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/lease_store.hpp"
#include "idl/http/http_post.hpp"

namespace collided::etcd {

/// etcd 3.4 and later, through its JSON gateway. Its members are tried in turn, beginning with the one that answered
/// last; each has patience_ns for an answer.
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
  /// What read(answer) makes of the first answer that is one.
  template <class Read>
  auto call(const char* target, const nlohmann::json& question, Read&& read);
  nlohmann::json ask(const EtcdEndpoint& endpoint, const char* target, const std::string& question);

  const EtcdAddress address_;
  const std::int64_t patience_ns_;
  const http::HttpModule& http_;
  std::size_t newest_ = 0;  // the endpoint that answered last
};

}  // namespace collided::etcd
