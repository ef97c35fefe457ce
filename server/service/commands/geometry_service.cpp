#include "server/service/commands/geometry_service.hpp"

#include <algorithm>

#include "idl/commands.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

namespace names = wire_contract::command;
using wire_contract::ReplyStatus;

GeometryService::GeometryService(const World& world, CommandAnswers& answers)
    : world_(world), answers_(answers), jobs_(kMostJobs) {
  jobs_.serve("geometry", [this](const Job& job) { answer(job.ask, job.handler); });
}

void GeometryService::stop() {
  stopping_.store(true);
  jobs_.finish();
}

std::vector<BoundCommand> GeometryService::commands() {
  const auto queued = [this](const char* name, Handler handler) -> BoundCommand {
    return {.name = name, .hand_on = [this, handler](CommandAsk ask, const Arguments&) {
              if (!jobs_.has_room() || !jobs_.push({std::move(ask), handler}))
                throw BadCommand("too many viewers ask for shapes already", "ask again");
            }};
  };
  return {queued(names::kShapes, &GeometryService::shapes),
          queued(names::kSurface, &GeometryService::surface),
          queued(names::kSnapshot, &GeometryService::snapshot),
          queued(names::kMore, &GeometryService::more),
          {.name = names::kPoses,
           .hand_on = [this](const CommandAsk& ask, const Arguments&) { answer(ask, &GeometryService::poses); }}};
}

void GeometryService::answer(const CommandAsk& ask, Handler handler) {
  try {
    if (stopping_.load()) throw BadCommand("the server is stopping");
    answers_.send(ask, ReplyStatus::ok, (this->*handler)(Arguments(ask.text)));
  } catch (const BadCommand& bad) { answers_.refuse(ask, bad); } catch (const std::bad_alloc&) {
    answers_.refuse(ask, "not enough memory");
  }
}

std::string GeometryService::poses(const Arguments&) { return encode_poses(*world_.newest()); }

std::string GeometryService::shapes(const Arguments& arguments) {
  const std::string only = arguments.text("only");
  const std::string skip = arguments.text("skip");
  const std::uint64_t mask = arguments.whole("mask");
  const std::optional<bool> moving = arguments.truth_if_given("moving");
  const SnapshotRing::Lease state = world_.newest();
  return first_page(encode_objects(
      *state,
      [&](const ObjectInfo& info) {
        return (info.filter.layers & mask) != 0 && (!moving || info.moving == *moving) &&
               (only.empty() || glob_matches(only, info.name)) && (skip.empty() || !glob_matches(skip, info.name));
      },
      numbers_));
}

std::string GeometryService::snapshot(const Arguments&) { return first_page(encode_snapshot(*world_.newest())); }

std::string GeometryService::surface(const Arguments& arguments) {
  const double cosine = arguments.number("crease_cosine");
  if (!(cosine >= -1 && cosine <= 1)) throw BadCommand("surface: crease_cosine is out of range; allowed: -1 to 1");
  const SurfaceNumbers::Found found = numbers_.find(arguments.whole("surface"));
  const bool is_ours = arguments.whole("epoch") == world_.newest()->epoch;
  // An empty page means that the surface is gone, for example after a restart: the viewer asks for the shapes again.
  if (!is_ours || !found.mesh) return encode_page(0, 0, 0, {});
  return first_page(encode_surface(found, arguments.truth("edges") ? std::optional(cosine) : std::nullopt));
}

/// The next page of a buffer. The last page ends the transfer; any other makes it the last to be dropped.
std::string GeometryService::more(const Arguments& arguments) {
  const std::uint64_t number = arguments.whole("transfer");
  const std::uint64_t first = arguments.whole("first");
  const auto found =
      std::find_if(transfers_.begin(), transfers_.end(), [&](const Transfer& t) { return t.number == number; });
  if (found == transfers_.end()) return encode_page(0, 0, 0, {});
  const std::string_view bytes = found->bytes;
  if (first >= bytes.size()) throw BadCommand("more: first is beyond the end");
  const std::string page = encode_page(number, bytes.size(), first, bytes.substr(first, kPageBytes));
  if (bytes.size() - first <= kPageBytes) {
    transfers_.erase(found);
  } else {
    found->asked_at = Clock::now();
    transfers_.splice(transfers_.end(), transfers_, found);
  }
  return page;
}

std::string GeometryService::first_page(std::string bytes) {
  if (bytes.size() <= kPageBytes) return encode_page(0, bytes.size(), 0, bytes);
  make_room(bytes.size());
  transfers_.push_back({.number = ++newest_transfer_, .bytes = std::move(bytes), .asked_at = Clock::now()});
  const Transfer& kept = transfers_.back();
  return encode_page(kept.number, kept.bytes.size(), 0, std::string_view(kept.bytes).substr(0, kPageBytes));
}

/// Drops stale transfers, then the stalest ones until there is room for `byte_count` more.
void GeometryService::make_room(std::size_t byte_count) {
  std::uint64_t kept = byte_count;
  for (const Transfer& transfer : transfers_) kept += transfer.bytes.size();
  const Clock::time_point stale = Clock::now() - kPatience;
  while (!transfers_.empty() &&
         (transfers_.front().asked_at < stale || kept > kMostKeptBytes || transfers_.size() >= kMostTransfers)) {
    kept -= transfers_.front().bytes.size();
    transfers_.pop_front();
  }
}

}  // namespace collided::engine::service
