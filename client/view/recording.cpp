#include "client/view/recording.hpp"

#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "client/view/assets.hpp"
#include "client/view/page_feed.hpp"
#include "client/view/page_messages.hpp"
#include "idl/base64.hpp"

namespace collided::view {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

std::string packed(std::string_view bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::string out(size, '\0');
  const int failed = ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
  if (failed != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

/// JSON in which nothing can end or begin an HTML element. Names may contain anything, and the text is put into a
/// script element.
std::string without_elements(std::string_view json_text) {
  std::string text;
  for (const char c : json_text) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

void replace(std::string& text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  if (at != std::string::npos) text.replace(at, what.size(), with);
}

std::string_view asset(std::string_view path) {
  for (const Asset& one : assets()) {
    if (one.path == path) return one.text;
  }
  return {};
}

/// Records the messages that a live page would get, with their times.
class Recorder {
 public:
  explicit Recorder(std::size_t most_bytes)
      : feed_([this](const WebMessage& message) { hear(message); }), most_bytes_(most_bytes) {}

  Observer& observer() { return feed_; }
  bool is_full() const {
    const std::lock_guard lock(mutex_);
    return bytes_ >= most_bytes_;
  }
  SavedRun finish(const RecordingOptions& options) &&;

 private:
  struct SavedMessage {
    double at_s = 0;
    const char* kind = "text";
    std::string data;
  };

  void hear(const WebMessage& message);
  void keep(const char* kind, std::string data);
  void keep_table(const ShownObjects& shown);

  PageFeed feed_;
  const std::size_t most_bytes_;
  const Clock::time_point begin_ = Clock::now();
  mutable std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::vector<SavedMessage> messages_;
  std::map<std::string, std::string> surfaces_;  // by epoch and number
};

void Recorder::hear(const WebMessage& message) {
  if (!message.is_text) return keep("poses", packed(*message.bytes));
  const json told = json::parse(*message.bytes, nullptr, false);
  const bool is_table = told.is_object() && told.value("type", "") == "table";
  if (!is_table) return keep("text", *message.bytes);
  // A page would fetch the table now.
  if (const auto shown = feed_.shown()) keep_table(*shown);
}

void Recorder::keep_table(const ShownObjects& shown) {
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

void Recorder::keep(const char* kind, std::string data) {
  const double at_s = std::chrono::duration<double>(Clock::now() - begin_).count();
  const std::lock_guard lock(mutex_);
  if (bytes_ >= most_bytes_) return;
  bytes_ += data.size();
  messages_.push_back({at_s, kind, std::move(data)});
}

SavedRun Recorder::finish(const RecordingOptions& options) && {
  const std::lock_guard lock(mutex_);
  SavedRun saved;
  saved.is_full = bytes_ >= most_bytes_;
  saved.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  json messages = json::array();
  messages.push_back({{"t", 0}, {"kind", "text"}, {"data", hello_text(options.y_is_up, options.connection)}});
  for (const SavedMessage& message : messages_) {
    const bool is_text = std::string_view(message.kind) == "text";
    saved.frames += std::string_view(message.kind) == "poses" ? 1 : 0;
    messages.push_back(
        {{"t", message.at_s}, {"kind", message.kind}, {"data", is_text ? message.data : encode_base64(message.data)}});
  }
  json surfaces = json::object();
  for (const auto& [key, bytes] : surfaces_) surfaces[key] = encode_base64(bytes);
  const json run{{"begin", 0}, {"end", saved.seconds}, {"messages", messages}, {"surfaces", surfaces}};
  saved.page = asset("/");
  replace(saved.page, R"(<link rel="stylesheet" href="view.css">)",
          "<style>\n" + std::string(asset("/view.css")) + "</style>");
  replace(saved.page, R"(<script src="view.js"></script>)",
          R"(<script type="application/json" id="run">)" +
              without_elements(run.dump(-1, ' ', false, json::error_handler_t::replace)) + "</script>\n<script>\n" +
              std::string(asset("/view.js")) + "</script>");
  return saved;
}

}  // namespace

Result<SavedRun> record_run(Client& client, const RecordingOptions& options) {
  Recorder recorder(options.most_bytes);
  FollowOptions follow;
  follow.is_watched = [] { return true; };
  Result<std::unique_ptr<Follower>> follower = Follower::start(client, recorder.observer(), follow);
  if (!follower) return follower.error();
  const Clock::time_point end = Clock::now() + options.length;
  constexpr std::chrono::milliseconds kLook{50};
  while (Clock::now() < end && !options.is_stopped() && !recorder.is_full()) std::this_thread::sleep_for(kLook);
  follower->reset();
  return std::move(recorder).finish(options);
}

}  // namespace collided::view
