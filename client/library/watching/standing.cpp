#include "client/library/watching/standing.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/publishing/shape_encoding.hpp"
#include "client/library/watching/event_queue.hpp"
#include "client/library/watching/watch_feed.hpp"
#include "idl/answers/standing.hpp"
#include "idl/commands.hpp"
#include "idl/packed_fences.hpp"

namespace collided::client {
namespace {

namespace names = wire_contract::command;

constexpr std::chrono::seconds kStandingTimeout{10};
/// Limit for a message with many questions: DDS delivers none above kMaxMessageBytes.
constexpr std::size_t kMostStandingBytes = wire_contract::kMaxMessageBytes - 64 * 1024;

// ---- the arguments of each form ------------------------------------------------------------------------------------

/// Writes the arguments of a form. Returns the value that JSON cannot represent or the server would misread; empty:
/// none.
struct Arguments {
  nlohmann::json& into;

  std::string operator()(const Region& region) const {
    if (!region.to.empty()) into["to"] = region.to;
    if (!region.enter || !region.exit || !region.cross) {
      nlohmann::json& detect = into["detect"] = nlohmann::json::array();
      if (region.enter) detect.push_back("enter");
      if (region.exit) detect.push_back("exit");
      if (region.cross) detect.push_back("cross");
    }
    if (!region.prism) return region.shape.empty() ? "its shape has no part" : "";
    nlohmann::json& prism = into["prism"] = {region.prism->low_m, region.prism->high_m};
    for (const std::array<double, 2>& corner : region.prism->corners) {
      prism.push_back(corner[0]);
      prism.push_back(corner[1]);
    }
    return {};
  }
  std::string operator()(const Bands& bands) const {
    if (!std::ranges::all_of(bands.bands_m, [](double m) { return std::isfinite(m); })) return "a band is not finite";
    if (!std::isfinite(bands.hysteresis_m)) return "its hysteresis is not finite";
    if (bands.dwell.count() < 0) return "its dwell is negative";
    into["around"] = bands.around;
    into["bands"] = bands.bands_m;
    into["hysteresis"] = bands.hysteresis_m;
    into["dwell_ns"] = bands.dwell.count();
    return {};
  }
  std::string operator()(const Nearest& nearest) const {
    if (!std::isfinite(nearest.within_m) || !std::isfinite(nearest.hysteresis_m)) return "a distance is not finite";
    if (nearest.point && !nearest.point->allFinite()) return "the point is not finite";
    if (!nearest.to.empty()) into["to"] = nearest.to;
    if (nearest.point) into["point"] = json_of(*nearest.point);
    into["within"] = nearest.within_m;
    into["hysteresis"] = nearest.hysteresis_m;
    return {};
  }
};

/// A question in its wire form: its arguments, and the shape of a region that has one.
struct Encoded {
  std::string text;
  std::vector<std::uint8_t> shape;
};

Result<Encoded> encoded(const Standing& standing) {
  const std::string called = "standing question '" + standing.name + "'";
  nlohmann::json arguments{{"command", names::kFence}, {"name", standing.name}, {"keep", standing.keep}};
  if (!standing.only.empty()) arguments["only"] = standing.only;
  if (!standing.skip.empty()) arguments["skip"] = standing.skip;
  if (standing.mask != 0xffffffff) arguments["mask"] = standing.mask;
  if (const std::string reason = std::visit(Arguments{arguments}, standing.of); !reason.empty())
    return bad_input(called + ": " + reason);
  Encoded encoded;
  try {
    encoded.text = arguments.dump();
  } catch (const nlohmann::json::exception&) {
    return bad_input("standing question: a name or glob is not UTF-8 text");
  }
  const auto* const region = std::get_if<Region>(&standing.of);
  if (region == nullptr || region->prism) return encoded;
  Result<std::vector<std::uint8_t>> shape = encode_shape(region->shape, Vec3::Ones(), called);
  if (!shape) return shape.error();
  encoded.shape = std::move(*shape);
  return encoded;
}

nlohmann::json by_name(const std::string& name, std::optional<StandingForm> form) {
  nlohmann::json arguments{{"name", name}};
  if (form) arguments["form"] = name_of(*form);
  return arguments;
}

// ---- events --------------------------------------------------------------------------------------------------------

/// The events of a StandingWatch; only requested ones enter the queue.
///
/// threads  any
class StandingSource : public StandingWatch::Source {
 public:
  StandingSource(std::shared_ptr<Connection> connection, const StandingWatchOptions& options)
      : options_(options),
        events_(options.capacity),
        feed_(std::move(connection), [this](const StandingNews& news) { take(news); }) {}

  std::optional<Error> start() {
    if (auto error = feed_.wait_for_server()) return error;
    feed_.run();
    return std::nullopt;
  }
  std::optional<StandingEvent> next(std::chrono::nanoseconds wait) override { return events_.next(wait); }
  SubscriptionHealth health() const override { return feed_.health(events_.lost()); }

 private:
  void take(const StandingNews& news) {
    std::optional<StandingEvent> event = event_of(news);
    if (event && is_wanted(*event, options_)) events_.push(std::move(*event));
  }

  StandingWatchOptions options_;
  EventQueue<StandingEvent> events_;
  WatchFeed<StandingNews> feed_;  // destroyed first, since its thread uses the rest
};

}  // namespace

Result<AddedStanding> add_standing(Connection& connection, const Standing& standing) {
  Result<Encoded> one = encoded(standing);
  if (!one) return one.error();
  return read_answer(
      command_with_blob(connection, names::kFence, one->text, one->shape, kStandingTimeout, {}), names::kFence,
      [](const nlohmann::json& answer) { return AddedStanding{.parts = answer.value("parts", std::uint64_t{0})}; });
}

Result<void> add_standing(Connection& connection, std::span<const Standing> standing) {
  std::vector<std::uint8_t> bytes;
  const auto send = [&]() -> Result<void> {
    if (bytes.empty()) return {};
    Result<void> sent =
        read_answer(command_with_blob(connection, names::kFence, R"({"many":true})", bytes, kStandingTimeout, {}),
                    names::kFence, [](const nlohmann::json&) {});
    bytes.clear();
    return sent;
  };
  for (const Standing& each : standing) {
    Result<Encoded> one = encoded(each);
    if (!one) return one.error();
    if (bytes.size() + one->text.size() + one->shape.size() > kMostStandingBytes) {
      if (Result<void> sent = send(); !sent) return sent.error();
    }
    wire_contract::pack_fence(bytes, one->text, one->shape);
  }
  return send();
}

Result<std::size_t> remove_standing(Connection& connection, const std::string& name, std::optional<StandingForm> form) {
  nlohmann::json arguments = by_name(name, form);
  arguments["remove"] = true;
  return read_answer(command(connection, names::kFence, arguments, kStandingTimeout), names::kFence,
                     [](const nlohmann::json& answer) { return answer.at("standing").size(); });
}

Result<std::vector<ListedStanding>> list_standing(Connection& connection, const std::string& name_glob,
                                                  std::optional<StandingForm> form) {
  nlohmann::json arguments = by_name(name_glob, form);
  arguments["limit"] = 1'000'000;
  return read_answer(command(connection, names::kFences, arguments, kStandingTimeout), names::kFences,
                     [](const nlohmann::json& answer) {
                       std::vector<ListedStanding> all;
                       read_json(answer.at("standing"), {}, all);
                       return all;
                     });
}

Result<StandingWatch> watch_standing(std::shared_ptr<Connection> connection, const StandingWatchOptions& options) try {
  auto source = std::make_unique<StandingSource>(std::move(connection), options);
  if (auto error = source->start()) return *error;
  return StandingWatch(std::move(source));
} catch (const dds::DdsError& failed) { return failure_of(failed); }

}  // namespace collided::client
