#include "server/service/runtime/dds_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <spdlog/logger.h>

namespace collided::engine::service {

DdsWarnings::DdsWarnings(std::shared_ptr<spdlog::logger> log) : log_(std::move(log)) {
  dds_set_log_sink(
      [](void* self, const dds_log_data_t* data) {
        // An exception could not unwind through C's frames. Without memory for it, the warning is lost.
        try {
          static_cast<DdsWarnings*>(self)->take(*data);
        } catch (const std::exception&) {}
      },
      this);
}

DdsWarnings::~DdsWarnings() { dds_set_log_sink(nullptr, nullptr); }

std::uint64_t DdsWarnings::count(const dds_log_data_t& data) {
  constexpr std::chrono::minutes kSilence{1};
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  Kind& kind = kinds_[{data.file == nullptr ? "" : data.file, data.line}];
  if (now - kind.last > kSilence) kind.count = 0;
  kind.last = now;
  return ++kind.count;
}

void DdsWarnings::take(const dds_log_data_t& data) {
  constexpr std::uint64_t kAllOf = 8;
  // The header that DDS would print is not part of the message.
  std::string_view message(data.message, data.size);
  while (message.ends_with('\n')) message.remove_suffix(1);
  // "data(application, vendor 1.15): GUID #1: deserialization TOPIC/TYPE failed (...)"
  constexpr std::string_view kBegin = "deserialization ", kEnd = " failed";
  const std::size_t begin = message.find(kBegin), end = message.find(kEnd, begin);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin + kBegin.size()) {
    const std::uint64_t of_kind = count(data);
    if (of_kind > kAllOf && !std::has_single_bit(of_kind)) return;
    constexpr std::size_t kMostBytes = 400;
    std::string text(message.substr(0, kMostBytes));
    std::ranges::replace(text, '\n', ' ');
    log_->warn("DDS: {}{}{}", text, message.size() > kMostBytes ? "..." : "",
               of_kind < kAllOf ? "" : fmt::format(" ({} of this kind)", of_kind));
    return;
  }
  const std::uint64_t left_out = ++unreadable_;
  if (!std::has_single_bit(left_out)) return;
  log_->warn(
      "a sample of {} was left out: it cannot be read, so the program that wrote it has another version of "
      "idl/collided.idl. Left out so far: {}. DDS: {}",
      message.substr(begin + kBegin.size(), end - begin - kBegin.size()), left_out, message.substr(0, begin));
}

}  // namespace collided::engine::service
