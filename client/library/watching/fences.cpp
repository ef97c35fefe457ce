#include "client/library/watching/fences.hpp"

#include <algorithm>
#include <utility>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/publishing/shape_encoding.hpp"
#include "idl/commands.hpp"
#include "idl/packed_fences.hpp"

namespace collided {
namespace client {
namespace {

namespace names = wire_contract::command;

constexpr std::chrono::seconds kFenceTimeout{10};
/// A message of many fences stays below this: DDS delivers none above kMaxMessageBytes.
constexpr std::size_t kMostFenceBytes = wire_contract::kMaxMessageBytes - 64 * 1024;

nlohmann::json arguments_of(const Fence& fence) {
  nlohmann::json arguments{{"command", names::kFence}, {"name", fence.name}, {"keep", fence.keep}};
  if (!fence.to.empty()) arguments["to"] = fence.to;
  if (!fence.only.empty()) arguments["only"] = fence.only;
  if (!fence.skip.empty()) arguments["skip"] = fence.skip;
  if (fence.mask != 0xffffffff) arguments["mask"] = fence.mask;
  if (!fence.enter || !fence.exit || !fence.cross) {
    arguments["tells"] = nlohmann::json::array();
    if (fence.enter) arguments["tells"].push_back("enter");
    if (fence.exit) arguments["tells"].push_back("exit");
    if (fence.cross) arguments["tells"].push_back("cross");
  }
  if (fence.prism) {
    arguments["prism"] = {fence.prism->low_m, fence.prism->high_m};
    for (const std::array<double, 2>& corner : fence.prism->corners) {
      arguments["prism"].push_back(corner[0]);
      arguments["prism"].push_back(corner[1]);
    }
  }
  return arguments;
}

/// A fence as it is sent: its arguments, and its shape where it has one.
struct EncodedFence {
  std::string text;
  std::vector<std::uint8_t> shape;
};

Result<EncodedFence> encoded(const Fence& fence) {
  EncodedFence encoded;
  try {
    encoded.text = arguments_of(fence).dump();
  } catch (const nlohmann::json::exception&) { return bad_input("fence: a name or glob is not UTF-8 text"); }
  if (fence.prism) return encoded;
  if (fence.shape.empty()) return bad_input("fence '" + fence.name + "': its shape has no part");
  Result<std::vector<std::uint8_t>> shape = encode_shape(fence.shape, Vec3::Ones(), "fence '" + fence.name + "'");
  if (!shape) return shape.error();
  encoded.shape = std::move(*shape);
  return encoded;
}

ListedFence listed_of(const nlohmann::json& row) {
  ListedFence fence{.name = row.at("fence"),
                    .kind = row.at("kind"),
                    .to = row.at("to"),
                    .only = row.at("only"),
                    .skip = row.at("skip"),
                    .keep = row.at("keep"),
                    .inside = row.at("inside"),
                    .in_doubt = row.at("in_doubt")};
  for (const nlohmann::json& word : row.at("tells")) {
    fence.enter = fence.enter || word == "enter";
    fence.exit = fence.exit || word == "exit";
    fence.cross = fence.cross || word == "cross";
  }
  return fence;
}

}  // namespace

Result<void> add_fence(Connection& connection, const Fence& fence) {
  Result<EncodedFence> one = encoded(fence);
  if (!one) return one.error();
  return read_answer(command_with_blob(connection, names::kFence, one->text, one->shape, kFenceTimeout, {}), "fence",
                     [](const nlohmann::json&) {});
}

Result<void> add_fences(Connection& connection, std::span<const Fence> fences) {
  std::vector<std::uint8_t> bytes;
  const auto send = [&]() -> Result<void> {
    if (bytes.empty()) return {};
    Result<void> sent =
        read_answer(command_with_blob(connection, names::kFence, R"({"many":true})", bytes, kFenceTimeout, {}), "fence",
                    [](const nlohmann::json&) {});
    bytes.clear();
    return sent;
  };
  for (const Fence& fence : fences) {
    Result<EncodedFence> one = encoded(fence);
    if (!one) return one.error();
    if (bytes.size() + one->text.size() + one->shape.size() > kMostFenceBytes) {
      if (Result<void> sent = send(); !sent) return sent.error();
    }
    wire_contract::pack_fence(bytes, one->text, one->shape);
  }
  return send();
}

Result<std::size_t> remove_fences(Connection& connection, const std::string& name) {
  const nlohmann::json arguments{{"name", name}, {"remove", true}};
  return read_answer(command(connection, names::kFence, arguments, kFenceTimeout), "fence",
                     [](const nlohmann::json& answer) { return answer.at("fences").size(); });
}

Result<std::vector<ListedFence>> list_fences(Connection& connection, const std::string& name_glob) {
  const nlohmann::json arguments{{"name", name_glob}, {"limit", 1'000'000}};
  return read_answer(command(connection, names::kFences, arguments, kFenceTimeout), "fences",
                     [](const nlohmann::json& answer) {
                       std::vector<ListedFence> fences;
                       for (const nlohmann::json& row : answer.at("fences")) fences.push_back(listed_of(row));
                       return fences;
                     });
}

}  // namespace client

}  // namespace collided
