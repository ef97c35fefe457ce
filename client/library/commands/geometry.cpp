#include "client/library/commands/geometry.hpp"

#include <unordered_map>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/commands/geometry_decoding.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using nlohmann::json;
namespace names = wire_contract::command;

constexpr std::uint64_t kMostAnswerBytes = std::uint64_t{1} << 30;  // of one answer; the server sends no larger ones
constexpr int kAttempts = 5;

}  // namespace

Error unfit(const char* command, const std::string& flaw) {
  return Error{ErrorCode::internal, std::string(command) + ": the server's answer does not fit: " + flaw,
               "server and library may be of different versions"};
}

namespace {

/// Surfaces by number: known ones are reused, others are fetched.
class SurfaceBook {
 public:
  SurfaceBook(Connection& connection, const ShapesOptions& options) : connection_(connection), options_(options) {}

  void take_over(const ShownObjects& earlier) {
    for (const ShownObject& object : earlier.objects) {
      for (const SurfaceRun& run : object.runs) {
        if (options_.edges == !run.surface->edges.empty()) surfaces_.emplace(run.surface->number, run.surface);
      }
    }
  }

  /// A surface; null if the server no longer has it.
  Result<std::shared_ptr<const Surface>> get(std::uint64_t epoch, std::uint64_t number) {
    if (const auto known = surfaces_.find(number); known != surfaces_.end()) return known->second;
    const json arguments{
        {"surface", number}, {"epoch", epoch}, {"edges", options_.edges}, {"crease_cosine", options_.crease_cosine}};
    const Result<std::optional<std::string>> bytes =
        fetch_pages(connection_, names::kSurface, arguments, options_.timeout);
    if (!bytes) return bytes.error();
    if (!*bytes) return std::shared_ptr<const Surface>();
    std::string flaw;
    std::optional<Surface> surface = decode_surface(**bytes, flaw);
    if (!surface) return unfit(names::kSurface, flaw);
    surface->number = number;
    return surfaces_[number] = std::make_shared<const Surface>(std::move(*surface));
  }

 private:
  Connection& connection_;
  const ShapesOptions& options_;
  std::unordered_map<std::uint64_t, std::shared_ptr<const Surface>> surfaces_;
};

/// Fetches the objects with their surfaces. If a surface has disappeared since the objects were listed: nothing or,
/// with may_lack, the objects that do not need it.
Result<std::optional<ShownObjects>> attempt(Connection& connection, const ShapesOptions& options,
                                            const ShownObjects* earlier, SurfaceBook& book, bool may_lack) {
  json arguments{{"only", options.only}, {"skip", options.skip}, {"mask", options.mask}};
  if (options.moving) arguments["moving"] = *options.moving;
  const Result<std::optional<std::string>> bytes = fetch_pages(connection, names::kShapes, arguments, options.timeout);
  if (!bytes) return bytes.error();
  if (!*bytes) return std::optional<ShownObjects>();
  std::string flaw;
  std::optional<DecodedObjects> decoded = decode_objects(**bytes, flaw);
  if (!decoded) return unfit(names::kShapes, flaw);
  // Numbers of surfaces are valid within an epoch.
  if (earlier != nullptr && earlier->epoch == decoded->shown.epoch) book.take_over(*earlier);
  std::vector<ShownObject> whole;
  for (std::size_t i = 0; i < decoded->runs.size(); ++i) {
    ShownObject& object = decoded->shown.objects[i];
    bool has_gone = false;
    for (const NumberedRun& run : decoded->runs[i]) {
      const Result<std::shared_ptr<const Surface>> surface = book.get(decoded->shown.epoch, run.surface);
      if (!surface) return surface.error();
      if (!*surface && !may_lack) return std::optional<ShownObjects>();
      has_gone = has_gone || !*surface;
      if (has_gone) break;
      const std::size_t count = (*surface)->triangles.size();
      if (run.first_triangle > count || run.triangle_count > count - run.first_triangle) {
        return unfit(names::kShapes, "a run goes beyond its surface");
      }
      object.runs.push_back({*surface, run.first_triangle, run.triangle_count, run.is_hull});
    }
    if (!has_gone) whole.push_back(std::move(object));
  }
  decoded->shown.objects = std::move(whole);
  return std::optional(std::move(decoded->shown));
}

}  // namespace

Result<std::optional<std::string>> fetch_pages(Connection& connection, const char* command_name, json arguments,
                                               std::chrono::nanoseconds timeout,
                                               const std::function<bool(double)>& progress) {
  std::string all;
  const char* name = command_name;
  std::optional<std::uint64_t> total;
  do {
    // A name that is not UTF-8 must not throw here; the server finds no object for it.
    const std::string written = arguments.dump(-1, ' ', false, json::error_handler_t::replace);
    const Result<std::string> text = command(connection, name, written, {}, timeout, {});
    if (!text) return text.error();
    std::string flaw;
    const std::optional<Page> page = decode_page(*text, flaw);
    if (!page) return unfit(command_name, flaw);
    if (page->total == 0) return std::optional<std::string>();
    const bool fits = page->first == all.size() && !page->bytes.empty() && page->total == total.value_or(page->total) &&
                      page->total <= kMostAnswerBytes && page->bytes.size() <= page->total - all.size();
    if (!fits) return unfit(command_name, "its pages do not follow each other");
    total = page->total;
    all += page->bytes;
    if (progress && !progress(static_cast<double>(all.size()) / static_cast<double>(*total)))
      return Error{ErrorCode::refused, std::string(command_name) + ": called off", "nothing was kept"};
    name = names::kMore;
    arguments = {{"transfer", page->transfer}, {"first", all.size()}};
  } while (all.size() < *total);
  return std::optional(std::move(all));
}

Result<ShownObjects> shapes(Connection& connection, const ShapesOptions& options, const ShownObjects* earlier) {
  for (int i = 0; i < kAttempts; ++i) {
    SurfaceBook book(connection, options);
    const bool is_last = i + 1 == kAttempts;
    Result<std::optional<ShownObjects>> shown = attempt(connection, options, earlier, book, is_last);
    if (!shown) return shown.error();
    if (*shown) return std::move(**shown);
  }
  return Error{ErrorCode::timeout,
               "shapes: the server forgot what it was telling, " + std::to_string(kAttempts) + " times",
               "ask again, or name fewer objects"};
}

Result<Poses> poses(Connection& connection, std::chrono::nanoseconds timeout) {
  const Result<std::string> text = command(connection, names::kPoses, {}, {}, timeout, {});
  if (!text) return text.error();
  std::string flaw;
  std::optional<Poses> decoded = decode_poses(*text, flaw);
  if (!decoded) return unfit(names::kPoses, flaw);
  return std::move(*decoded);
}

}  // namespace collided::client
