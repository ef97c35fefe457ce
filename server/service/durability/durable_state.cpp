#include "server/service/durability/durable_state.hpp"

#include <fmt/format.h>

#include <charconv>
#include <future>
#include <utility>

namespace collided::engine::service {
namespace {

constexpr std::string_view kScene = "scene/";
constexpr std::string_view kObject = "object/";
constexpr std::string_view kMoved = "moved/";
constexpr std::string_view kProbe = "probe/";
constexpr std::string_view kPublisher = "publisher/";
constexpr std::string_view kCovers = "covers";

std::string key(std::string_view kind, std::string_view name) { return fmt::format("{}{}", kind, name); }
std::string key(std::uint64_t publisher) { return fmt::format("{}{:016x}", kPublisher, publisher); }

}  // namespace

DurableState::DurableState(std::unique_ptr<Disk> disk, const std::string& file, bool crashed, Notice notice)
    : journal_(std::move(disk), file), notice_(std::move(notice)), jobs_(kMostJobs) {
  if (!journal_.damage().empty()) notice_(journal_.damage());
  if (crashed) {
    for (const std::string_view kind : {kScene, kObject, kMoved, kProbe}) {
      for (const Journal::Entry& entry : journal_.entries()) {
        if (entry.key.starts_with(kind)) commands_left_.push_back({0, 0, entry.text, entry.blob});
      }
    }
    for (const Journal::Entry& entry : journal_.entries()) {
      had_covers_ = had_covers_ || entry.key == kCovers;
      std::uint64_t publisher = 0;
      const char* end = entry.key.data() + entry.key.size();
      if (!entry.key.starts_with(kPublisher)) continue;
      if (std::from_chars(entry.key.data() + kPublisher.size(), end, publisher, 16).ptr == end)
        publishers_left_.push_back(publisher);
    }
  }
  // After a crash, what was left stays until it is forgotten: the next crash may come before it has been carried out
  // again.
  if (!crashed) journal_.clear();
  publishers_.insert(publishers_left_.begin(), publishers_left_.end());
  say_problem();
  thread_ = std::thread([this] {
    while (std::optional<Job> job = jobs_.pop()) (*job)();
  });
}

DurableState::~DurableState() { finish(); }

void DurableState::finish() {
  jobs_.close();
  if (thread_.joinable()) thread_.join();
}

/// Reports each new problem, and the end of one.
void DurableState::say_problem() {
  if (journal_.problem() == said_) return;
  said_ = journal_.problem();
  notice_(said_.empty() ? "what is added is kept over a crash again"
                        : said_ + "; what is added now is lost with a crash");
}

void DurableState::put(Journal::Entry entry, Journal::Sync sync) {
  keys_.insert(entry.key);
  jobs_.push([this, entry = std::move(entry), sync] {
    journal_.put(entry, sync);
    say_problem();
  });
}

void DurableState::erase(std::vector<std::string> keys, Journal::Sync sync) {
  for (const std::string& key : keys) keys_.erase(key);
  jobs_.push([this, keys = std::move(keys), sync] {
    journal_.erase(keys, sync);
    say_problem();
  });
}

void DurableState::scene_loaded(const std::string& scene, const CommandAsk& ask) {
  put({.key = key(kScene, scene), .text = ask.text, .blob = {}}, Journal::Sync::now);
}

void DurableState::covers_stated() {
  if (!keys_.contains(std::string(kCovers)))
    put({.key = std::string(kCovers), .text = {}, .blob = {}}, Journal::Sync::now);
}

void DurableState::object_added(const std::string& object, const CommandAsk& ask) {
  // The move of an earlier object of this name, in this process, must not apply to the new one. A move that a crashed
  // process left is not in keys_ and waits to be carried out.
  if (keys_.contains(key(kMoved, object))) erase({key(kMoved, object)}, Journal::Sync::now);
  put({.key = key(kObject, object), .text = ask.text, .blob = ask.blob}, Journal::Sync::now);
}

void DurableState::object_moved(const std::string& object, const CommandAsk& ask) {
  if (keys_.contains(key(kObject, object)))
    put({.key = key(kMoved, object), .text = ask.text, .blob = {}}, Journal::Sync::now);
}

void DurableState::probe_set(const std::string& probe, const CommandAsk& ask) {
  put({.key = key(kProbe, probe), .text = ask.text, .blob = {}}, Journal::Sync::now);
}

void DurableState::probes_removed(const std::vector<std::string>& probes) {
  std::vector<std::string> gone;
  for (const std::string& probe : probes) {
    if (keys_.contains(key(kProbe, probe))) gone.push_back(key(kProbe, probe));
  }
  if (!gone.empty()) erase(std::move(gone), Journal::Sync::now);
}

void DurableState::keep_only(const std::function<bool(std::string_view)>& has_scene,
                             const std::function<bool(std::string_view)>& has_object) {
  std::vector<std::string> gone;
  for (const std::string_view key : keys_) {
    for (const std::string_view kind : {kScene, kObject, kMoved}) {
      if (key.starts_with(kind) && !(kind == kScene ? has_scene : has_object)(key.substr(kind.size())))
        gone.emplace_back(key);
    }
  }
  if (!gone.empty()) erase(std::move(gone), Journal::Sync::now);
}

void DurableState::set_publishers(const std::set<std::uint64_t>& publishers) {
  if (publishers == publishers_ || !jobs_.has_room()) return;
  std::vector<std::string> gone;
  for (const std::uint64_t publisher : publishers_) {
    if (!publishers.contains(publisher)) gone.push_back(key(publisher));
  }
  if (!gone.empty()) erase(std::move(gone), Journal::Sync::later);
  for (const std::uint64_t publisher : publishers) {
    if (!publishers_.contains(publisher)) put({.key = key(publisher), .text = {}, .blob = {}}, Journal::Sync::later);
  }
  publishers_ = publishers;
}

void DurableState::wait(std::chrono::milliseconds longest) {
  const auto written = std::make_shared<std::promise<void>>();
  then([written](const std::string&) { written->set_value(); });
  written->get_future().wait_for(longest);
}

void DurableState::then(std::function<void(const std::string&)> done) {
  const bool taken = jobs_.push([this, done] { done(journal_.problem()); });
  if (!taken) done("the server is stopping");
}

}  // namespace collided::engine::service
