#include "server/service/first_look.hpp"

#include <algorithm>

namespace collided::engine::service {

std::optional<long> heard_primary(const dds::Participant& participant, const std::string& name_space, bool uses_keys,
                                  std::int64_t least_ns) {
  std::optional<long> pid;
  hear_servers<wire::Status>(participant, name_space, std::max(listening_ns(uses_keys), least_ns),
                             [&](const wire::Status& status) {
                               pid = static_cast<long>(status.pid);
                               return true;
                             });
  return pid;
}

}  // namespace collided::engine::service
