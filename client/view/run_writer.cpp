#include "client/view/run_writer.hpp"

#include <algorithm>
#include <new>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "client/view/json_text.hpp"
#include "idl/base64.hpp"

namespace collided::view {
namespace {

using nlohmann::json;

std::string packed(std::string_view bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::string out(size, '\0');
  const int failed = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
  if (failed != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace

RunWriter::RunWriter(std::size_t most_bytes, Now now)
    : feed_([this](const WebMessage& message) { hear(message); }), most_bytes_(most_bytes), now_(std::move(now)) {}

bool RunWriter::is_full() const {
  const std::lock_guard lock(mutex_);
  return bytes_ >= most_bytes_;
}

std::size_t RunWriter::frame_count() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(std::ranges::count(messages_, std::string_view("poses"), &SavedMessage::kind));
}

void RunWriter::hear(const WebMessage& message) {
  if (!message.is_text) return keep("poses", packed(*message.bytes));
  const json parsed = json::parse(*message.bytes, nullptr, false);
  const bool is_table = parsed.is_object() && parsed.value("type", "") == "table";
  if (!is_table) return keep("text", *message.bytes);
  // A page would fetch the table now.
  if (const auto shown = feed_.shown()) keep_table(*shown);
}

void RunWriter::keep_table(const ShownObjects& shown) {
  if (const auto table = feed_.page("/objects")) keep("objects", packed(*table->body));
  for (const std::uint64_t number : feed_.surfaces()) {
    const std::string key = std::to_string(shown.epoch) + " " + std::to_string(number);
    {
      const std::lock_guard lock(mutex_);
      if (surfaces_.contains(key)) continue;
    }
    const auto surface = feed_.page("/surface?number=" + std::to_string(number));
    if (!surface) continue;
    std::string bytes = packed(*surface->body);
    const std::lock_guard lock(mutex_);
    bytes_ += bytes.size();
    surfaces_.emplace(key, std::move(bytes));
  }
}

void RunWriter::keep(const char* kind, std::string data) {
  const double at_s = now_();
  const std::lock_guard lock(mutex_);
  if (bytes_ >= most_bytes_) return;
  bytes_ += data.size();
  messages_.push_back({at_s, kind, std::move(data)});
}

/// The text is assembled piece by piece, since a JSON value of it would need its memory twice.
std::string RunWriter::finish(double seconds, const std::vector<std::string>& notes) const {
  const std::lock_guard lock(mutex_);
  std::string run = R"({"begin":0,"end":)" + text_of(seconds) + R"(,"notes":)" + text_of(notes) + R"(,"messages":[)";
  const char* separator = "";
  for (const SavedMessage& message : messages_) {
    const std::string_view kind = message.kind;
    run += separator + (R"({"t":)" + text_of(message.at_s)) + R"(,"kind":")" + message.kind + R"(","data":)";
    if (kind == "text") run += text_of(message.data);
    else run += '"' + encode_base64(message.data) + '"';
    run += '}';
    separator = ",";
  }
  run += R"(],"surfaces":{)";
  separator = "";
  for (const auto& [key, bytes] : surfaces_) {
    run += separator + ('"' + key) + R"(":")" + encode_base64(bytes) + '"';
    separator = ",";
  }
  return run + "}}";
}

}  // namespace collided::view
