#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "client/cli/output/output.hpp"

// The answers to the command explain (idl/commands.hpp), for people as lines and for machines as one record. The usual
// fields are those of plain output, without the lists.
namespace collided::cli {

/// A number that the server writes as "inf" where it is.
double number_or_inf(const nlohmann::json& answer, const char* key);
/// A time in nanoseconds; 0 where there is none.
std::chrono::nanoseconds time_at(const nlohmann::json& row, const char* key);
/// How objects stand to a fence, a line each: "  WORD     NAME  0.2 m deep".
void print_standings(Printer& printer, std::string_view word, const nlohmann::json& rows);
/// The last events of a fence, or of a question for the nearest.
void print_last_events(Printer& printer, const nlohmann::json& events);
/// Which objects a fence looks at, by its globs and mask.
std::string looked_at(const nlohmann::json& answer);

/// The world's version; of a recording's nothing.
Value version_of(const nlohmann::json& answer);

std::vector<std::string> usual_explained_ray_fields();
Record explained_ray_record(const nlohmann::json& answer);
void print_explained_ray(Printer& printer, const nlohmann::json& answer);

std::vector<std::string> usual_explained_fence_fields();
Record explained_fence_record(const nlohmann::json& answer);
void print_explained_fence(Printer& printer, const nlohmann::json& answer);

std::vector<std::string> usual_explained_nearest_fields();
Record explained_nearest_record(const nlohmann::json& answer);
void print_explained_nearest(Printer& printer, const nlohmann::json& answer);

std::vector<std::string> usual_explained_event_fields();
Record explained_event_record(const nlohmann::json& answer);
void print_explained_event(Printer& printer, const nlohmann::json& answer);

}  // namespace collided::cli
