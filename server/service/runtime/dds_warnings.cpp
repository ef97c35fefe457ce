#include "server/service/runtime/dds_warnings.hpp"

#include <bit>
#include <utility>

#include "idl/dds.hpp"

namespace collided::engine::service {

DdsWarnings::DdsWarnings(std::shared_ptr<spdlog::logger> log) : log_(std::move(log)) {
  dds_set_log_sink(
      [](void* self, const dds_log_data_t* data) {
        static_cast<DdsWarnings*>(self)->take(std::string_view(data->message, data->size).substr(data->hdrsize));
      },
      this);
}

DdsWarnings::~DdsWarnings() { dds_set_log_sink(nullptr, nullptr); }

void DdsWarnings::take(std::string_view message) {
  while (message.ends_with('\n')) message.remove_suffix(1);
  // "data(application, vendor 1.15): GUID #1: deserialization TOPIC/TYPE failed (...)"
  constexpr std::string_view kBegin = "deserialization ", kEnd = " failed";
  const std::size_t begin = message.find(kBegin), end = message.find(kEnd, begin);
  if (begin == std::string_view::npos || end == std::string_view::npos) {
    log_->warn("DDS: {}", message);
    return;
  }
  const std::uint64_t count = ++unreadable_;
  if (!std::has_single_bit(count)) return;
  log_->warn(
      "a sample of {} was left out: it cannot be read, so the program that wrote it has another version of "
      "idl/collided.idl. Left out so far: {}. DDS: {}",
      message.substr(begin + kBegin.size(), end - begin - kBegin.size()), count, message.substr(0, begin));
}

}  // namespace collided::engine::service
