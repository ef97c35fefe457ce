#include "client/cli/output/metavars.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace collided::cli {
namespace {

/// By option; most options of the same name take the same kind of value in every verb.
constexpr std::array kMetavars = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"--against", "GLOB"},
    {"--as-of", "TIME"},
    {"--at", "X Y Z"},
    {"--attach", "NAME=NAME"},
    {"--back", "LENGTH"},
    {"--bands", "N"},
    {"--because", "TEXT"},
    {"--bind", "ADDRESS"},
    {"--by", "WHAT"},
    {"--center", "X Y Z"},
    {"--clearance", "LENGTH"},
    {"--clearance-of", "GLOB"},
    {"--cloud", "TOPIC=NAME"},
    {"--color", "WHEN"},
    {"--covers", "BOX"},
    {"--crack", "LENGTH"},
    {"--crease", "ANGLE"},
    {"--days", "N"},
    {"--deadline", "TIME"},
    {"--decay", "TIME"},
    {"--detect", "WORDS"},
    {"--dir", "DIR"},
    {"--domain", "N"},
    {"--dwell", "TIME"},
    {"--every", "TIME"},
    {"--exec", "COMMAND"},
    {"--fields", "NAMES"},
    {"--for", "TIME"},
    {"--format", "TEXT"},
    {"--into", "N"},
    {"--margin", "LENGTH"},
    {"--fov", "ANGLE"},
    {"--frame", "FRAME"},
    {"--from", "X Y Z"},
    {"--group", "N"},
    {"--host", "NAME"},
    {"--hysteresis", "LENGTH"},
    {"--importance", "LEVEL"},
    {"--interface", "NAME"},
    {"--joints", "FILE"},
    {"--keys", "DIR"},
    {"--last", "TIME"},
    {"--layers", "BITS"},
    {"--length", "LENGTH"},
    {"--light", "X Y Z"},
    {"--limit", "N"},
    {"--markers", "TOPIC"},
    {"--mask", "BITS"},
    {"--max-hits", "N"},
    {"--most", "N"},
    {"--name", "NAME"},
    {"--namespace", "NAME"},
    {"--nearer", "LENGTH"},
    {"--objects", "GLOB"},
    {"--octomap", "TOPIC=NAME"},
    {"--of", "KIND"},
    {"--on", "OBJECT"},
    {"--only", "GLOB"},
    {"--opinion", "WHOSE"},
    {"--origin", "X Y Z"},
    {"--package", "NAME=DIR"},
    {"--peer", "HOST"},
    {"--port", "N"},
    {"--pose", "TOPIC=FRAME"},
    {"--protection", "KIND"},
    {"--quat", "W X Y Z"},
    {"--questions", "N"},
    {"--post", "URL"},
    {"--radius", "LENGTH"},
    {"--rate", "FACTOR"},
    {"--ray", "NUMBERS"},
    {"--reach", "LENGTH"},
    {"--recording", "FILE"},
    {"--repeat", "N"},
    {"--rm", "GLOB"},
    {"--robot", "FILE"},
    {"--role", "ROLE"},
    {"--ros-domain", "N"},
    {"--ros-interface", "NAME"},
    {"--ros-peer", "HOST"},
    {"--rpy", "R P Y"},
    {"--save", "FILE"},
    {"--scene", "FILE"},
    {"--scale", "FACTOR"},
    {"--seed", "N"},
    {"--shards", "MAP"},
    {"--since", "TIME"},
    {"--size", "SIZE"},
    {"--skip", "GLOB"},
    {"--solid-only", "GLOB"},
    {"--split", "NAME"},
    {"--srdf", "FILE"},
    {"--style", "NAME"},
    {"--timeout", "TIME"},
    {"--to", "X Y Z"},
    {"--to-rpy", "R P Y"},
    {"--tones", "N"},
    {"--unit", "UNIT"},
    {"--unknown", "WORD"},
    {"--voxels", "LENGTH"},
    {"--up", "AXIS"},
    {"--wait", "TIME"},
    {"--when-lost", "WHAT"},
    {"--why-not", "OBJECT"},
    {"--width", "N"},
    {"--within", "LENGTH"},
    {"--as", "NAME"},
    {"--bone-radius", "LENGTH"},
    {"--gap", "TIME"},
    {"--path", "FILE"},
    {"--polygons", "N"},
    {"--response", "NAME"},
    {"--revision", "N"},
    {"--restitution", "FACTOR"},
    {"--shape", "SHAPE"},
    {"--side", "LENGTH"},
    {"--speed", "SPEED"},
    {"--spheres", "N"},
    {"--spin", "RATE"},
    {"--steps", "N"},
    {"--stiffness", "NUMBER"},
    {"--waypoints", "POINTS"},
    {"-k", "N"},
    {"-n", "N"},
    {"-o", "FILE"},
});

struct VerbMetavar {
  std::string_view verb;
  std::string_view option;
  std::string_view metavar;
};
/// Where a verb's option takes something else than others of that name.
constexpr std::array kMetavarsOfVerbs = std::to_array<VerbMetavar>({
    {"clearance", "--to", "GLOB"},
    {"draw", "--clearance", "GLOB"},
    {"events", "--from", "TIME"},
    {"events", "--to", "TIME"},
    {"fence", "--to", "OBJECT"},
    {"fleet", "--to", "MAP"},
    {"menu", "--from", "FILE"},
    {"publish", "--rate", "HZ"},
    {"view", "--origin", "URL"},
});

}  // namespace

std::string_view metavar_of(std::string_view verb, std::string_view option) {
  for (const VerbMetavar& own : kMetavarsOfVerbs) {
    if (own.verb == verb && own.option == option) return own.metavar;
  }
  const auto* found = std::ranges::find(kMetavars, option, &std::pair<std::string_view, std::string_view>::first);
  return found == kMetavars.end() ? std::string_view() : found->second;
}

}  // namespace collided::cli
