#pragma once

#include <string>
#include <vector>

#include "client/cli/input/question.hpp"

namespace collided::cli {

/// Reads the questions of a file ("-": stdin), in any form that a batch may have, as the numbers that the command menu
/// takes. Throws Failure for a line that is not a question, for no questions, and for more than the server takes.
std::vector<double> read_menu_questions(const std::string& path, QuestionKind kind, int in);

}  // namespace collided::cli
