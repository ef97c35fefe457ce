#include "client/cli/output/metavars.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace collided::cli {
namespace {

/// By option; options of the same name take the same kind of value in every verb.
constexpr std::array kMetavars = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"--as-of", "TIME"},
    {"--at", "X Y Z"},
    {"--back", "LENGTH"},
    {"--bands", "N"},
    {"--bind", "ADDRESS"},
    {"--center", "X Y Z"},
    {"--clearance", "LENGTH"},
    {"--color", "WHEN"},
    {"--covers", "BOX"},
    {"--crack", "LENGTH"},
    {"--crease", "ANGLE"},
    {"--deadline", "TIME"},
    {"--domain", "N"},
    {"--every", "TIME"},
    {"--exec", "COMMAND"},
    {"--fields", "NAMES"},
    {"--for", "TIME"},
    {"--format", "TEXT"},
    {"--fov", "ANGLE"},
    {"--from", "FROM"},
    {"--group", "N"},
    {"--host", "NAME"},
    {"--importance", "LEVEL"},
    {"--interface", "NAME"},
    {"--last", "TIME"},
    {"--layers", "BITS"},
    {"--length", "LENGTH"},
    {"--light", "X Y Z"},
    {"--limit", "N"},
    {"--mask", "BITS"},
    {"--max-hits", "N"},
    {"--most", "N"},
    {"--name", "NAME"},
    {"--namespace", "NAME"},
    {"--of", "KIND"},
    {"--on", "OBJECT"},
    {"--only", "GLOB"},
    {"--opinion", "WHOSE"},
    {"--origin", "X Y Z"},
    {"--peer", "HOST"},
    {"--port", "N"},
    {"--quat", "W X Y Z"},
    {"--questions", "N"},
    {"--radius", "LENGTH"},
    {"--rate", "FACTOR"},
    {"--ray", "NUMBERS"},
    {"--reach", "LENGTH"},
    {"--repeat", "N"},
    {"--rm", "GLOB"},
    {"--rpy", "R P Y"},
    {"--save", "FILE"},
    {"--scale", "FACTOR"},
    {"--seed", "N"},
    {"--since", "TIME"},
    {"--size", "SIZE"},
    {"--skip", "GLOB"},
    {"--solid-only", "GLOB"},
    {"--srdf", "FILE"},
    {"--style", "NAME"},
    {"--timeout", "TIME"},
    {"--to", "TO"},
    {"--to-rpy", "R P Y"},
    {"--tones", "NAME"},
    {"--unit", "UNIT"},
    {"--up", "AXIS"},
    {"--wait", "TIME"},
    {"--when-lost", "WHAT"},
    {"--width", "N"},
    {"--within", "LENGTH"},
    {"--as", "NAME"},
    {"--bone-radius", "LENGTH"},
    {"--path", "FILE"},
    {"--polygons", "N"},
    {"--response", "NAME"},
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

}  // namespace

std::string_view metavar_of(std::string_view option) {
  const auto* found = std::ranges::find(kMetavars, option, &std::pair<std::string_view, std::string_view>::first);
  return found == kMetavars.end() ? std::string_view() : found->second;
}

}  // namespace collided::cli
