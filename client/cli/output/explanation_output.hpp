#pragma once

#include <string>

#include <collided/explanations.hpp>

#include "client/cli/output/output.hpp"

/// Explanations, for people as lines and for machines as one record. The usual fields are those of plain output,
/// without the lists. One from a recording has version 0.
namespace collided::cli {

void print_explained(Printer& printer, const ExplainedRay& ray);
void print_explained(Printer& printer, const ExplainedStanding& standing);
void print_explained(Printer& printer, const ExplainedEvent& event);
/// pair  of its answer only verdict, distance, depth, error, stale and version are needed
void print_explained(Printer& printer, const std::string& a, const std::string& b, const ExplainedPair& pair);

}  // namespace collided::cli
