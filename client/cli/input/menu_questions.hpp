#pragma once

#include <string>
#include <vector>

#include "client/cli/input/question.hpp"

namespace collided::cli {

/// The questions of a file, in any form that a batch may have ("-": stdin), as the numbers that the command menu takes.
/// throws    Failure for a line that is no question, a file without any, and one of more than the server takes
std::vector<double> read_menu_questions(const std::string& path, QuestionKind kind, int in);

}  // namespace collided::cli
