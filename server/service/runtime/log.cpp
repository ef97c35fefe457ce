#include "server/service/runtime/log.hpp"

#include <spdlog/formatter.h>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string_view>

#include "idl/terminal_text.hpp"

namespace collided::engine::service {
namespace {

class JsonFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const auto since = std::chrono::duration<double>(message.time.time_since_epoch()).count();
    const auto level = spdlog::level::to_string_view(message.level);
    const nlohmann::ordered_json fields{{"time", since},
                                        {"level", std::string(level.data(), level.size())},
                                        {"message", std::string(message.payload.data(), message.payload.size())}};
    const std::string text = fields.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

/// Messages contain text of clients and other servers: it must not control the terminal that shows the log.
class PlainFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    std::string text = wire_contract::terminal_text({message.payload.data(), message.payload.size()});
    // A line without a time belongs to the one above, so that no text can imitate a message.
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) {
      if (text.compare(at + 1, 2, "  ") != 0) text.insert(at + 1, "  ");
    }
    spdlog::details::log_msg safe = message;
    safe.payload = text;
    pattern_.format(safe, line);
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<PlainFormatter>(); }

 private:
  spdlog::pattern_formatter pattern_{"%H:%M:%S.%e %l: %v"};
};

}  // namespace

std::shared_ptr<spdlog::logger> make_log(const std::string& level, bool json) {
  auto log = std::make_shared<spdlog::logger>("collided", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_level(spdlog::level::from_str(level == "error" ? "err" : level));
  if (json) log->set_formatter(std::make_unique<JsonFormatter>());
  else log->set_formatter(std::make_unique<PlainFormatter>());
  log->flush_on(spdlog::level::trace);
  return log;
}

}  // namespace collided::engine::service
