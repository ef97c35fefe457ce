#include <charconv>
#include <cstdlib>

#include "client/library/connection/errors.hpp"
#include "collided/client.hpp"
#include "idl/etcd_option.hpp"
#include "idl/topics.hpp"

namespace collided {
namespace {

std::string variable_of_process(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? "" : text;
}

}  // namespace

Result<ConnectOptions> ConnectOptions::from_environment(const std::function<std::string(const char*)>& variable) {
  const auto of = [&](const char* name) { return variable ? variable(name) : variable_of_process(name); };
  ConnectOptions options;
  std::string domain = of("COLLIDED_DOMAIN");
  if (domain.empty()) domain = of("ROS_DOMAIN_ID");
  if (!domain.empty()) {
    const auto [end, error] = std::from_chars(domain.data(), domain.data() + domain.size(), options.domain);
    const bool is_number = error == std::errc{} && end == domain.data() + domain.size();
    if (!is_number || options.domain < 0 || options.domain > wire_contract::kLastDomain) {
      return client::bad_input("domain '" + domain + "': allowed 0 to " + std::to_string(wire_contract::kLastDomain),
                               "");
    }
  }
  if (const std::string name_space = of("COLLIDED_NAMESPACE"); !name_space.empty()) options.name_space = name_space;
  if (const std::string interface = of("COLLIDED_INTERFACE"); !interface.empty()) options.interface = interface;
  options.keys = of("COLLIDED_KEYS");
  options.etcd_keys = of(etcd::kEtcdKeysVariable);
  return options;
}

}  // namespace collided
