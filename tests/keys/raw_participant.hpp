#pragma once

#include <dds/dds.h>

#include <string>

#include "idl/dds.hpp"
#include "tests/service/wire/network.hpp"

namespace collided::test {

/// A program that speaks DDS by itself. It uses the configuration of the product, with one change: what it makes is not
/// checked against its own permissions.
class RawParticipant {
 public:
  /// place  tells the participants of this process apart, 0 to 2
  RawParticipant(const std::string& keys, int place) {
    // Of this process alone, and one that its keys are good for.
    const auto number = static_cast<dds_domainid_t>(1 + place);
    std::string config = dds::domain_config({.domain = own_domain(), .role = dds::Role::server, .keys = keys});
    replace(config, "init_access_control", "lenient_begin");
    replace(config, "finalize_access_control", "lenient_end");
    replace_path_of(config, "lenient_begin", COLLIDED_LENIENT_ACCESS);
    domain_ = dds::Entity(dds::check(dds_create_domain(number, config.c_str()), "create domain"));
    participant_ = dds::Entity(dds::check(dds_create_participant(number, nullptr, nullptr), "create participant"));
  }
  dds_entity_t get() const { return participant_.get(); }

 private:
  static void replace(std::string& text, const std::string& old_text, const std::string& new_text) {
    const std::size_t at = text.find(old_text);
    if (at != std::string::npos) text.replace(at, old_text.size(), new_text);
  }
  /// The path of the library element with this function.
  static void replace_path_of(std::string& text, const std::string& function, const std::string& path) {
    const std::size_t at = text.find(function);
    if (at == std::string::npos) return;
    const std::size_t first = text.rfind("path=\"", at) + 6;
    text.replace(first, text.find('"', first) - first, path);
  }

  dds::Entity domain_;
  dds::Entity participant_;
};

}  // namespace collided::test
