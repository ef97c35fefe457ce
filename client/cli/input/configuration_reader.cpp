#include "client/cli/input/configuration_reader.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/question.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/text_row.hpp"

namespace collided::cli {
namespace {

Pose pose_in(const nlohmann::json& value, const std::string& name) {
  const bool right_size = value.is_array() && (value.size() == 3 || value.size() == 7);
  if (!right_size) throw bad_use(fmt::format("'{}' must hold 3 or 7 numbers: x y z qw qx qy qz", printable(name)));
  std::array<double, 7> numbers{0, 0, 0, 1, 0, 0, 0};
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!value[i].is_number())
      throw bad_use(fmt::format("{} in '{}'", value[i].dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                                printable(name)));
    numbers[i] = value[i].get<double>();
  }
  return {.position = {numbers[0], numbers[1], numbers[2]},
          .rotation = unit_quaternion(numbers[3], numbers[4], numbers[5], numbers[6])};
}

}  // namespace

ConfigurationReader::ConfigurationReader(const InputFile& file) : file_(file), lines_(file.descriptor()) {
  while (!has_line_ && lines_.next(text_)) has_line_ = !is_blank_line(text_);
  if (!has_line_ || text_[text_.find_first_not_of(" \t")] == '{') return;
  csv_.emplace(file, std::move(lines_), std::move(text_));
  read_row();
}

std::optional<ConfigurationReader::Configuration> ConfigurationReader::next() {
  return csv_ ? next_of_csv() : next_of_json();
}

/// Puts the poses into the order of the first configuration, and reports missing and extra ones.
void ConfigurationReader::put_in_order(const std::vector<NamedPose>& placed, Configuration& configuration) {
  if (objects_.empty()) {
    for (const NamedPose& one : placed) objects_.push_back(one.name);
  }
  configuration.poses.resize(objects_.size());
  std::vector<bool> has_pose(objects_.size(), false);
  for (const NamedPose& one : placed) {
    const auto known = std::ranges::find(objects_, one.name);
    if (known == objects_.end())
      throw bad_use(fmt::format("object '{}' is not in the first configuration", printable(one.name)));
    const auto place = static_cast<std::size_t>(known - objects_.begin());
    if (has_pose[place]) throw bad_use(fmt::format("object '{}' has two poses", printable(one.name)));
    has_pose[place] = true;
    configuration.poses[place] = one.pose;
  }
  const auto missing = std::ranges::find(has_pose, false);
  if (missing != has_pose.end())
    throw bad_use(fmt::format("object '{}' of the first configuration has no pose",
                              printable(objects_[static_cast<std::size_t>(missing - has_pose.begin())])));
}

void ConfigurationReader::read_row() {
  row_.emplace();
  refusal_.clear();
  if (csv_->next(*row_, refusal_) == PoseCsv::Found::end) row_.reset();
}

std::optional<ConfigurationReader::Configuration> ConfigurationReader::next_of_csv() {
  if (!row_) return std::nullopt;
  Configuration configuration{.id = row_->config, .poses = {}, .refusal = {}};
  std::vector<NamedPose> placed;
  const std::size_t first_line = csv_->line_number();
  for (; row_ && row_->config == configuration.id; read_row()) {
    if (refusal_.empty()) placed.push_back({row_->name, row_->pose});
    else if (configuration.refusal.empty()) configuration.refusal = refusal_;
  }
  if (!configuration.refusal.empty()) return configuration;
  try {
    put_in_order(placed, configuration);
  } catch (const Failure& failure) {
    configuration.refusal = fmt::format("{} line {}: {}", file_.name(), first_line, failure.what());
  }
  return configuration;
}

std::optional<ConfigurationReader::Configuration> ConfigurationReader::next_of_json() {
  while (!has_line_) {
    if (!lines_.next(text_)) return std::nullopt;
    has_line_ = !is_blank_line(text_);
  }
  has_line_ = false;
  Configuration configuration{.id = std::to_string(lines_.line_number()), .poses = {}, .refusal = {}};
  try {
    nlohmann::json object;
    try {
      object = nlohmann::json::parse(text_);
    } catch (const nlohmann::json::parse_error& error) {
      throw bad_use(fmt::format("column {}: not JSON", error.byte));
    }
    if (!object.is_object() || !object.contains("poses") || !object["poses"].is_object() || object["poses"].empty())
      throw bad_use("an object with the member 'poses' is needed, which names objects");
    if (object.contains("config")) {
      const nlohmann::json& id = object["config"];
      configuration.id =
          id.is_string() ? id.get<std::string>() : id.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
    std::vector<NamedPose> placed;
    for (const auto& [name, value] : object["poses"].items()) placed.push_back({name, pose_in(value, name)});
    put_in_order(placed, configuration);
  } catch (const Failure& failure) {
    configuration.refusal = fmt::format("{} line {}: {}", file_.name(), lines_.line_number(), failure.what());
  }
  return configuration;
}

}  // namespace collided::cli
