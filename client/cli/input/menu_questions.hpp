#pragma once

#include <string>
#include <vector>

#include "client/cli/input/question.hpp"

namespace collided::cli {

/// Reads the questions of a file ("-": stdin), in any form allowed in a batch, as the numbers of the command menu.
/// Throws Failure for a line that is not a question, for no questions, and for more than the server accepts.
std::vector<double> read_menu_questions(const std::string& path, QuestionKind kind, int in);

}  // namespace collided::cli
